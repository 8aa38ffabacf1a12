#include "runner/frame_loop.hpp"

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <vector>

#include "clothbench/error.hpp"
#include "runner/interrupt.hpp"

namespace clothbench {
namespace {

std::atomic<bool> interrupted{false}, held{false};
std::atomic<int> holds{0};
std::function<void()> report_frames;

void report_at_most_once_a_second() {
  static std::mutex mutex;  // reference solutions are computed on several threads
  static std::chrono::steady_clock::time_point reported;
  const std::unique_lock lock(mutex, std::try_to_lock);
  const auto now = std::chrono::steady_clock::now();
  if (!lock || now - reported < std::chrono::seconds(1)) return;
  reported = now;
  report_frames();
}

}  // namespace

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

/// Outside the clock: finds out whether there is a next frame, and restarts the scene at the end of a drop.
bool FrameLoop::begin() {
  const int next = index_ + 1 + behind_;
  if (failed() || next >= rules_.frames) return false;
  if (rules_.max_wall_s > 0 && elapsed_s_ >= rules_.max_wall_s && next >= rules_.min_frames) return false;
  if (rules_.end_after_s > 0 && next > rules_.first &&
      Clock::now() - first_begun_ >= std::chrono::duration<double>(rules_.end_after_s))
    return false;
  if (rules_.interrupted != nullptr) stop_if_interrupted(rules_.interrupted);
  if (next == rules_.first) first_begun_ = Clock::now();
  index_ = next;
  behind_ = 0;
  if (index_ > rules_.first && in_drop() == 0) solver_.reset();
  if (rules_.period_s > 0) wait_for_period();
  return true;
}

/// A frame that is late by more than a period does not make later frames hurry.
void FrameLoop::wait_for_period() {
  std::this_thread::sleep_until(due_);
  const std::chrono::duration<double> period(rules_.period_s);
  const auto now = Clock::now();
  due_ = (now - due_ > period ? now : due_) + std::chrono::duration_cast<Clock::duration>(period);
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

void request_interrupt() { interrupted = true; }
bool interrupt_requested() { return interrupted; }
void clear_interrupt() { interrupted = false; }

void hold_runs(bool on) {
  if (on && !held.exchange(true)) ++holds;
  if (!on) held = false;
}
int times_held() { return holds; }

FrameReports::FrameReports(std::function<void()> report) { report_frames = std::move(report); }
FrameReports::~FrameReports() { report_frames = nullptr; }

void stop_if_interrupted(const char* message) {
  if (report_frames) report_at_most_once_a_second();
  while (held && !interrupted) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  if (interrupted) throw Error(message, ExitCode::Interrupted);
}

}  // namespace clothbench
