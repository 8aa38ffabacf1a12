#include "runner/frame_input.hpp"

namespace clothbench {

FrameInput frame_input(const Scene& scene, int index) {
  const TimeSpan& time = scene.time;
  const FrameMotion* motion = scene.motion_after(index);
  if (time.ends_s.empty()) return {index, (index + 1) * time.dt(), time.dt(), motion};
  const int beyond = index + 1 - time.frames();
  if (beyond > 0) return {index, time.at(time.frames()) + beyond * time.dt(), time.dt(), motion};
  return {index, time.at(index + 1), time.dt_after(index), motion};
}

}  // namespace clothbench
