#pragma once
#include <functional>
#include <memory>
#include <string>

#include "clothbench/record.hpp"
#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// Draws the state at the end of a frame as an application would show it; used for the frame time with rendering.
class FrameDrawer {
 public:
  virtual ~FrameDrawer() = default;
  /// Draws the cloth as the solver holds it after frame `frame` (0 = the start), and the colliders; complete on return.
  virtual void draw(int frame) = 0;
};

/// How frames are drawn in studies that time rendering; both are empty in others.
struct Rendering {
  /// Describes, for the result file, what is drawn and where positions come from.
  std::function<std::string(const SolverInfo&)> describe;
  /// Makes a drawer for a loaded solver, which the drawer reads and which must outlive it.
  std::function<std::unique_ptr<FrameDrawer>(const Scene&, const ClothSolver&, const DeviceOptions&)> make;
};

/// One planned run: one scene x one solver x one complete set of settings.
struct RunSpec {
  const Scene* scene = nullptr;
  const SolverEntry* entry = nullptr;
  nlohmann::json settings;
  std::string setting = "default";
  int work = 0;                                     ///< on a ladder of settings: multiple of the work of its first rung
  std::string over_budget = {};                     ///< reason why it is not run, if any; stored as it is
  std::map<std::string, double> scene_values = {};  ///< known values of the scene itself, added to every run's summary
};

/// Durations and repetitions; see results/README.md, "protocols".
struct TrialRules {
  int trials = 5;
  int frames = 72;                   ///< target per trial; 0 = all frames of the scene
  double max_wall_s = 0;             ///< a trial stops after this much wall time; 0 = no limit
  int min_frames = 12;               ///< ... but never before this many frames
  double warmup_s = 0.1;             ///< before each trial, outside the clock
  int drop_frames = 72;              ///< the scene restarts, outside the clock, after this many frames; 0 = never
  double accuracy_duration_s = 0.5;  ///< simulated time of the untimed pass
  double run_limit_s = 0;            ///< wall time of the untimed pass after which the run is `timed_out`; 0 = no limit
  double agree =
      0;  ///< trials end once two or more agree to this: half the range of frame rates over the median; 0 = never
  bool pipelined = false;    ///< also time the frames of a trial without waiting for each, if the solver supports it
  int profiled_frames = 12;  ///< frames of each trial run again with timestamps around stages; 0: none, and no bytes
  Rendering rendering = {};  ///< also time frames with rendering
};

/// Outcome of a run whose step ended with this status in frame `frame`.
Outcome outcome_of(StepStatus, int frame);

std::string run_name(const RunSpec&);  ///< as in its file names

/// Scalar: wall time of load and untimed pass [s].
inline constexpr char kUntimed[] = "untimed_s";

/// Header of a run before its solver is loaded, or whose solver is never loaded: the run's identity on this machine.
RunHeader header_of(const Scene&, const std::string& solver, const std::string& setting, const nlohmann::json& settings,
                    const std::string& protocol);

/// A loaded solver and its measurements.
class SolverRun {
 public:
  /// Loads the solver, unless the spec is over its budget. If the backend lacks a feature, or the entry has no `make`,
  /// the outcome is `unsupported`. If loading fails although the backend claims to support the scene, the outcome is
  /// `error`, or Error is thrown.
  SolverRun(RunSpec spec, const DeviceOptions& device, const std::string& protocol);

  const RunSpec& spec() const { return spec_; }
  const RunHeader& header() const { return header_; }
  /// Adds to the header how frames are drawn; call before it is written.
  void describe(const Rendering&);
  const Outcome& outcome() const { return outcome_; }
  bool alive() const { return solver_ != nullptr && outcome_.status == "ok"; }
  const Plan& plan() const { return plan_; }
  /// For a loop that paces itself; null unless alive.
  ClothSolver* solver() { return solver_.get(); }

  /// Takes over how the untimed pass ended that an earlier process stored. False if it ended none of this duration.
  bool take_over(const RunRecord& before, double duration_s);
  /// Runs the untimed pass: positions and metrics at every frame, frame 0 = initial state. `after_frame` gets the
  /// frames so far, without metrics.
  AccuracyPass run_accuracy(const TrialRules& rules, const std::function<void(const AccuracyPass&)>& after_frame = {});
  /// Runs one timed trial. `frames` > 0 sets the exact number (so that all trials of a run agree).
  TimedTrial run_trial(int index, const TrialRules& rules, int frames);
  /// Number of validation messages so far, from its solver and its twins; a run with any is not ok.
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
  TimedTrial counted_;                     ///< the bytes that a twin counted in the frames of a trial
  int counted_messages_ = 0;               ///< validation messages of that twin
};

/// Adds a frame's cost to a trial. The device times of its `stages` are unknown.
void add_frame(TimedTrial&, const FrameCost&, double wall_s, std::size_t stages);

/// Every scalar of the tables, from the record of one run. NaN where not applicable.
std::map<std::string, double> summarise(const RunSpec&, const Plan&, const RunRecord&);

/// Checks that a plan has no stage that the scene does not need. Its stages must serve exactly the features that the
/// scene needs, without those that the backend declares to ignore. Returns the extra and missing features, or "" if
/// there are none.
std::string check_stages(const Scene& scene, const SolverInfo& info, const Plan& plan);

}  // namespace clothbench
