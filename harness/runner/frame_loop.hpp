#pragma once
#include <chrono>
#include <ctime>
#include <limits>
#include <memory>
#include <nlohmann/json_fwd.hpp>

#include "clothbench/solver.hpp"

namespace clothbench {

/// Input of frame `index` of the scene (0 = the first). It includes hitch and jitter of the scene's clock, so that
/// every user of the scene has them. After the scene's end, where timed trials may continue, frames have equal length
/// and everything is static.
FrameInput frame_input(const Scene& scene, int index);

/// A solver with the scene loaded; the scene must outlive it.
std::unique_ptr<ClothSolver> load_solver(const SolverEntry&, const nlohmann::json& settings, const DeviceOptions&,
                                         const Scene&);

/// Selects the frames to step.
struct FrameRules {
  int first = 0;                            ///< index of the first frame; > 0 if the solver has already reached it
  int frames = 0;                           ///< index after the last frame
  int drop_frames = 0;                      ///< the scene restarts, untimed, after this number of frames; 0 = never
  double max_wall_s = 0;                    ///< no frame begins after this much timed wall time; 0 = no limit
  int min_frames = 0;                       ///< minimum number of frames, even beyond `max_wall_s`
  const char* interrupted = "interrupted";  ///< message thrown between frames on Ctrl-C; null: ignore Ctrl-C
  bool cpu_clock = false;                   ///< also read the CPU clock, outside the wall-clock interval
  double end_after_s = 0;  ///< no frame begins this long after the first, pauses included; 0 = no limit
  double period_s = 0;     ///< frames begin this long after each other, if they are on time; 0 = at once
};

inline constexpr int kAsManyAsItTakes = std::numeric_limits<int>::max();

/// The only loop that steps a solver through a scene. Accuracy passes, trials, references and conformance read what
/// they need after each frame:
///   for (FrameLoop loop(solver, scene, rules); loop.next();) …
/// The solver must already be in its start state: loaded, reset or restarted. The clock covers only the step: the
/// frame's input is prepared before it starts, and the step function is known at compile time.
class FrameLoop {
 public:
  FrameLoop(ClothSolver& solver, const Scene& scene, const FrameRules& rules)
      : solver_(solver), scene_(scene), rules_(rules), index_(rules.first - 1) {}

  /// Steps the next frame. False if there is none or the step failed. Throws Error (Interrupted) on Ctrl-C.
  bool next() {
    return next([this](const FrameInput& input) { return solver_.step(input); });
  }
  /// Steps and times `step`, a function FrameInput -> StepStatus, instead of the solver's step().
  template <class Step>
  bool next(Step&& step) {
    if (!begin()) return false;
    const FrameInput input = frame_input(scene_, in_drop());
    const double cpu_start_s = rules_.cpu_clock ? process_cpu_s() : 0;
    const auto start = Clock::now();
    status_ = step(input);
    const bool stepped = stop_clock(start);
    cpu_s_ = rules_.cpu_clock ? process_cpu_s() - cpu_start_s : 0;
    return stepped;
  }
  /// Times all frames up to the next restart (see drop_frames) as one interval, by ClothSolver::run_frames.
  bool next_drop();

  int index() const { return index_; }             ///< last frame begun, or first of a drop; initially `first` - 1
  int in_drop() const { return in_drop(index_); }  ///< index within the drop
  StepStatus status() const { return status_; }    ///< how the last frame ended
  bool failed() const { return status_ != StepStatus::Ok; }
  double wall_s() const { return wall_s_; }        ///< timed wall time of the last frame
  double cpu_s() const { return cpu_s_; }          ///< CPU time of the last frame, of all threads; 0 without the clock
  double elapsed_s() const { return elapsed_s_; }  ///< timed wall time of all frames

 private:
  using Clock = std::chrono::steady_clock;

  bool begin();
  void wait_for_period();
  /// CPU time of the process [s]: the stepping thread and all threads that a solver has started.
  static double process_cpu_s() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
  int in_drop(int frame) const { return rules_.drop_frames > 0 ? frame % rules_.drop_frames : frame; }
  bool stop_clock(Clock::time_point start) {
    wall_s_ = std::chrono::duration<double>(Clock::now() - start).count();
    elapsed_s_ += wall_s_;
    return !failed();
  }

  ClothSolver& solver_;
  const Scene& scene_;
  const FrameRules rules_;
  int index_, behind_ = 0;  ///< behind_: number of frames of the last drop after its first one
  StepStatus status_ = StepStatus::Ok;
  Clock::time_point first_begun_, due_;  ///< due_: of the next frame, if frames have a period
  double wall_s_ = 0, elapsed_s_ = 0, cpu_s_ = 0;
};

}  // namespace clothbench
