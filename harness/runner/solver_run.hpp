#pragma once
#include <functional>
#include <memory>
#include <string>

#include "clothbench/record.hpp"
#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// Draws the state at the end of a frame as an application would; used for frame times with rendering.
class FrameDrawer {
 public:
  virtual ~FrameDrawer() = default;
  /// Draws the colliders and the solver's cloth after frame `frame` (0 = the start); complete on return.
  virtual void draw(int frame) = 0;
};

/// Makes drawers in studies that time rendering; both functions are empty in other studies.
struct Rendering {
  /// Text for the result file: what is drawn, and where positions come from.
  std::function<std::string(const SolverInfo&)> describe;
  /// Makes a drawer for a loaded solver; the drawer reads the solver, which must outlive it.
  std::function<std::unique_ptr<FrameDrawer>(const Scene&, const ClothSolver&, const DeviceOptions&)> make;
};

/// One planned run: one scene x one solver x one complete set of settings.
struct RunSpec {
  const Scene* scene = nullptr;
  const SolverEntry* entry = nullptr;
  nlohmann::json settings;
  std::string setting = "default";
  int work = 0;                                     ///< in a settings sweep: work relative to its first setting
  std::string over_budget = {};                     ///< reason why it is not run, if any; stored unchanged
  std::map<std::string, double> scene_values = {};  ///< known scalars of the scene, added to every run's summary
  std::shared_ptr<const std::vector<double>> converged = {};  ///< positions with which the run is compared, if any
};

/// Durations and repetitions; see results/README.md, "protocols".
struct TrialRules {
  int trials = 5;
  int frames = 72;                   ///< target per trial; 0 = all frames of the scene
  double max_wall_s = 0;             ///< a trial stops after this wall time; 0 = no limit
  int min_frames = 12;               ///< ... but not before this many frames
  double warmup_s = 0.1;             ///< before each trial, outside the clock
  int drop_frames = 72;              ///< the scene restarts, outside the clock, after this many frames; 0 = never
  double accuracy_duration_s = 0.5;  ///< simulated time of the untimed pass
  double run_limit_s = 0;            ///< wall time after which the untimed pass is `timed_out`; 0 = no limit
  double agree =
      0;  ///< no further trials once half-range / median of at least two trials' frame rates is at most this; 0 = never
  bool pipelined = false;    ///< also time a trial's frames without waiting for each, if the solver supports it
  int profiled_frames = 12;  ///< frames per trial that run again with stage timestamps; 0: none, and no byte counts
  Rendering rendering = {};  ///< also time frames with rendering
  /// A trial is this long, at the scene's frame rate, with pauses between frames; 0: `frames` without pauses.
  double window_s = 0;
};

/// Outcome of a run whose step returned this status in frame `frame`.
Outcome outcome_of(StepStatus, int frame);

std::string run_name(const RunSpec&);  ///< the name that the run's files have

/// Scalar: wall time of load and untimed pass [s].
inline constexpr char kUntimed[] = "untimed_s";

/// Header of a run whose solver is not loaded (yet): the run's identity on this machine.
RunHeader header_of(const Scene&, const std::string& solver, const std::string& setting, const nlohmann::json& settings,
                    const std::string& protocol);

/// A loaded solver and its measurements.
class SolverRun {
 public:
  /// Loads the solver, unless the spec is over budget. If the backend lacks a feature, or the entry has no `make`, the
  /// outcome is `unsupported`. If loading fails although the solver declares support, the outcome is `error`, or Error
  /// is thrown.
  SolverRun(RunSpec spec, const DeviceOptions& device, const std::string& protocol);

  const RunSpec& spec() const { return spec_; }
  const RunHeader& header() const { return header_; }
  /// Adds the description of the rendering and the length of windows to the header; call before the header is written.
  void describe(const TrialRules&);
  const Outcome& outcome() const { return outcome_; }
  bool alive() const { return solver_ != nullptr && outcome_.status == "ok"; }
  const Plan& plan() const { return plan_; }
  /// For a caller with its own frame loop; null unless alive.
  ClothSolver* solver() { return solver_.get(); }

  /// Adopts the stored outcome of an earlier process's untimed pass. False if that pass has no outcome, was ok with
  /// another duration, or timed out on a GPU.
  bool take_over(const RunRecord& before, double duration_s);
  /// Runs the untimed pass: positions and metrics of every frame, frame 0 = initial state. `after_frame` gets the
  /// frames so far, without metrics.
  AccuracyPass run_accuracy(const TrialRules& rules, const std::function<void(const AccuracyPass&)>& after_frame = {});
  /// Runs one timed trial. `frames` > 0 sets the exact number of frames, so that all trials of a run are equally long.
  TimedTrial run_trial(int index, const TrialRules& rules, int frames);
  /// Number of validation messages of its solver and its twins so far; a run with any is not ok.
  int validation_messages() const {
    return counted_messages_ + (solver_ ? solver_->validation_messages() : 0) +
           (profiled_ ? profiled_->validation_messages() : 0);
  }

 private:
  int accuracy_frames(double duration_s) const;
  void fail(StepStatus status, int frame);
  void warm_up(const TrialRules& rules);
  void measure(TimedTrial& trial, const TrialRules& rules, int frames);
  void run_pipelined(TimedTrial& trial, const TrialRules& rules);
  void run_rendered(TimedTrial& trial, const TrialRules& rules);
  void profile_stages(TimedTrial& trial, int frames);
  void count_bytes(TimedTrial& trial, const TrialRules& rules);

  RunSpec spec_;
  DeviceOptions device_;
  RunHeader header_;
  Outcome outcome_;
  Plan plan_;
  std::unique_ptr<ClothSolver> solver_;
  std::unique_ptr<ClothSolver> profiled_;  ///< twin with per-stage timestamps, only on a GPU
  TimedTrial counted_;                     ///< bytes that a twin counted in the frames of a trial
  bool warm_ = false;                      ///< windows follow each other, so only the first is preceded by a warm-up
  int counted_messages_ = 0;               ///< validation messages of that twin
};

/// Adds a frame's cost to a trial. The device times of its `stages` are unknown.
void add_frame(TimedTrial&, const FrameCost&, double wall_s, std::size_t stages);

/// Every scalar for the tables, from the record of one run. NaN if not applicable.
std::map<std::string, double> summarise(const RunSpec&, const Plan&, const RunRecord&);

/// Checks that a plan has no superfluous stage: its stages must serve exactly the features that the scene needs, except
/// the ones that the solver declares to ignore. Returns the extra and missing features, or "" if there are none.
std::string check_stages(const Scene& scene, const SolverInfo& info, const Plan& plan);

}  // namespace clothbench
