#pragma once
#include <chrono>
#include <limits>
#include <memory>
#include <nlohmann/json_fwd.hpp>

#include "clothbench/solver.hpp"

namespace clothbench {

/// What changes in frame `index` of the scene (0 = the first), so that a hitch or a jitter of the scene's clock reaches
/// the solver wherever the scene is run. Past the scene's end, where timed trials may go on, frames are even and
/// nothing moves.
FrameInput frame_input(const Scene& scene, int index);

/// A solver with the scene in it, which outlives it.
std::unique_ptr<ClothSolver> load_solver(const SolverEntry&, const nlohmann::json& settings, const DeviceOptions&,
                                         const Scene&);

/// Which frames are stepped.
struct FrameRules {
  int first = 0;                            ///< for a solver that is there already
  int frames = 0;                           ///< one past the last
  int drop_frames = 0;                      ///< the scene begins again, outside the clock, after this many; 0 = never
  double max_wall_s = 0;                    ///< of time on the clock, after which no other frame begins; 0 = no limit
  int min_frames = 0;                       ///< ... but never before this many
  const char* interrupted = "interrupted";  ///< what is thrown between frames on Ctrl-C; null: it goes on
};

inline constexpr int kAsManyAsItTakes = std::numeric_limits<int>::max();

/// The one loop that steps a solver through a scene: accuracy passes, trials, references, thresholds, moduli and
/// metamorphic relations all read what they want of a frame once it is done:
///   for (FrameLoop loop(solver, scene, rules); loop.next();) …
/// The solver is where it is to begin: loaded, reset or restarted. The clock holds the step and nothing else: a frame's
/// input is made before it starts, and what is called within is known at compile time.
class FrameLoop {
 public:
  FrameLoop(ClothSolver& solver, const Scene& scene, const FrameRules& rules)
      : solver_(solver), scene_(scene), rules_(rules), index_(rules.first - 1) {}

  /// Steps the next frame. False where there is none or it did not end well. Throws Error (Interrupted) on Ctrl-C.
  bool next() {
    return next([this](const FrameInput& input) { return solver_.step(input); });
  }
  /// With `step`, FrameInput -> StepStatus, on the clock instead of the solver's own.
  template <class Step>
  bool next(Step&& step) {
    if (!begin()) return false;
    const FrameInput input = frame_input(scene_, in_drop());
    const auto start = Clock::now();
    status_ = step(input);
    return stop_clock(start);
  }
  /// All frames of the next drop, on one clock, without waiting for each (ClothSolver::run_frames).
  bool next_drop();

  int index() const { return index_; }  ///< of the last frame begun; of a drop its first. `first` - 1 before any
  int in_drop() const { return in_drop(index_); }  ///< ... counted from the scene's beginning
  StepStatus status() const { return status_; }    ///< of the last frame
  bool failed() const { return status_ != StepStatus::Ok; }
  double wall_s() const { return wall_s_; }        ///< on the clock, of the last frame
  double elapsed_s() const { return elapsed_s_; }  ///< ... of all frames

 private:
  using Clock = std::chrono::steady_clock;

  bool begin();
  int in_drop(int frame) const { return rules_.drop_frames > 0 ? frame % rules_.drop_frames : frame; }
  bool stop_clock(Clock::time_point start) {
    wall_s_ = std::chrono::duration<double>(Clock::now() - start).count();
    elapsed_s_ += wall_s_;
    return !failed();
  }

  ClothSolver& solver_;
  const Scene& scene_;
  const FrameRules rules_;
  int index_, behind_ = 0;  ///< behind_: frames of the last drop after its first
  StepStatus status_ = StepStatus::Ok;
  double wall_s_ = 0, elapsed_s_ = 0;
};

}  // namespace clothbench
