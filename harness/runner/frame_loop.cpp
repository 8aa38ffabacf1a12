#include "runner/frame_loop.hpp"

#include <vector>

#include "runner/interrupt.hpp"

namespace clothbench {

FrameInput frame_input(const Scene& scene, int index) {
  const TimeSpan& time = scene.time;
  const FrameMotion* motion = scene.motion_after(index);
  if (time.ends_s.empty()) return {index, (index + 1) * time.dt(), time.dt(), motion};
  const int beyond = index + 1 - time.frames();
  if (beyond > 0) return {index, time.at(time.frames()) + beyond * time.dt(), time.dt(), motion};
  return {index, time.at(index + 1), time.dt_after(index), motion};
}

std::unique_ptr<ClothSolver> load_solver(const SolverEntry& entry, const nlohmann::json& settings,
                                         const DeviceOptions& device, const Scene& scene) {
  auto solver = entry.make(settings, device);
  solver->load(scene);
  return solver;
}

/// Off the clock: whether there is a next frame, and the scene from its beginning where a drop ends.
bool FrameLoop::begin() {
  const int next = index_ + 1 + behind_;
  if (failed() || next >= rules_.frames) return false;
  if (rules_.max_wall_s > 0 && elapsed_s_ >= rules_.max_wall_s && next >= rules_.min_frames) return false;
  if (rules_.interrupted != nullptr) stop_if_interrupted(rules_.interrupted);
  index_ = next;
  behind_ = 0;
  if (index_ > rules_.first && in_drop() == 0) solver_.reset();
  return true;
}

bool FrameLoop::next_drop() {
  if (!begin()) return false;
  std::vector<FrameInput> inputs;
  for (int frame = index_; frame < rules_.frames && (frame == index_ || in_drop(frame) > 0); ++frame)
    inputs.push_back(frame_input(scene_, in_drop(frame)));
  behind_ = static_cast<int>(inputs.size()) - 1;
  const auto start = Clock::now();
  status_ = solver_.run_frames(inputs);
  return stop_clock(start);
}

}  // namespace clothbench
