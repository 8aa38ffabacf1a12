#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "clothbench/record.hpp"
#include "metrics/registry.hpp"

namespace clothbench {

/// A condition that must be equal in two compared runs. `kind`: word for `--allow`, which several conditions may share.
struct Condition {
  std::string kind, what, value;  ///< `value`: "–" if the run does not state it
};

/// The condition kinds, in order: "scene", "machine", "device", "precision", "length", "trials", "order".
const std::vector<std::string>& condition_kinds();

/// All conditions of a run, in the order of the kinds. A run that is not "ok" has neither "length" nor
/// "trials": that it ended early is a result, not a condition. A run without timed trials has no "trials".
std::vector<Condition> conditions_of(const RunRecord&);

struct ConditionDifference {
  std::string kind, what, a, b;
  bool operator==(const ConditionDifference&) const = default;
};

/// Conditions that both lists contain with different values.
std::vector<ConditionDifference> differences(const std::vector<Condition>& a, const std::vector<Condition>& b);

/// Keys that differ between the two resolved scenes, with both values: "/cloth/grid/0: 8, 24"; at most 4, then a count.
std::string scene_difference(const RunRecord& a, const RunRecord& b);

/// Condition differences of several runs, each with the runs in which it occurs.
class DifferingRuns {
 public:
  explicit DifferingRuns(std::vector<std::string> allowed = {}) : allowed_(std::move(allowed)) {}

  void add(const std::string& run, const ConditionDifference&);
  /// Throws Error with every difference that is not allowed, and both its values. `a`, `b`: names of the sides.
  void refuse(const std::string& a, const std::string& b) const;
  /// One line per allowed difference, as a note in the output; each line begins with `what`. Empty if none.
  std::string marks(const std::string& what = "Compared despite a difference, by --allow") const;
  nlohmann::json json() const;
  bool empty() const { return all_.empty(); }

 private:
  struct Entry {
    ConditionDifference difference;
    std::vector<std::string> runs;
  };
  std::string line(const Entry&) const;

  std::vector<std::string> allowed_;
  std::vector<Entry> all_;
};

/// Key of a run.
struct RunKey {
  std::string scene, solver, setting;
  // Not <=>: the libc++ of Android's NDK r25 does not yet define it for strings.
  bool operator==(const RunKey&) const = default;
  bool operator<(const RunKey& o) const {
    return std::tie(scene, solver, setting) < std::tie(o.scene, o.solver, o.setting);
  }

  std::string file_name() const;  ///< "<scene>__<solver>__<setting>", the name of the result file
};

/// The part of a run that does not depend on the machine.
struct BaselineRun {
  RunKey key;
  std::vector<Condition> conditions;  ///< all that affect results: not machine, driver, device profile, trials
  std::string status, klass;
  int failed_frame = -1;
  std::vector<std::string> stages;        ///< "<name> (<feature>, <feature>)" in order
  std::map<std::string, double> scalars;  ///< only those with a regression rule; NaN or absent = not measured
};

struct Baseline {
  std::vector<BaselineRun> runs;  ///< sorted by key, no key twice
};

/// The part of a result that the regression rules cover, without scalars that are not finite (not measured).
BaselineRun gated_part(const RunRecord&);
/// As gated_part, but with every scalar that does not depend on the machine.
BaselineRun whole_part(const RunRecord&);

/// Reads and checks a baseline. Throws Error with file and JSON pointer (line and column if the text is not JSON) for
/// an unknown or missing key, a scalar without a regression rule, or a run that is listed twice.
Baseline read_baseline(const std::filesystem::path&);

/// Text of a baseline file: one line per value, sorted; numbers are read back exactly.
std::string baseline_text(const Baseline&);

/// results/baselines/baseline.schema.json, compiled in.
extern const char* const kBaselineSchema;

/// Regression rule of a summary scalar; nullptr: it is not compared. Verdicts of bounds have no tolerance.
const Gate* find_gate(const std::string& name);

/// Whether the scalar is the verdict of a bound: 1 pass, 0 fail. A change from 1 to 0 fails, from 0 to 1 improves.
bool is_verdict(const std::string& name);

std::vector<std::string> gated_names();

/// Allowed deviation from `baseline` in each direction [unit of the scalar]. `length_m`: shorter side of the cloth.
double slack(const Gate&, double baseline, double length_m);

/// "0.01 L + 10 %; none at 0", where L is the shorter side.
std::string slack_text(const Gate&);

/// Minimum number of processes per side for a statement about times. With 5 and 5 the test has a size of 4.8 %.
inline constexpr std::size_t kMinProcesses = 5;
inline constexpr std::size_t kMaxProcesses = 12;  ///< per side; the test evaluates all C(24, 12) assignments

/// Ratio of the frame times B/A, estimated from processes. Processes are the units of replication, because the trials
/// of one process share its memory layout, clocks and driver state. `ratio`: ratio of the geometric means over the
/// processes. `p`: exact permutation test of the difference of the mean logarithms, over all assignments of the
/// processes to the two sides; twice the smaller tail. `low`, `high`: smallest and largest ratio that this test does
/// not reject at 5 % (equal tails of at most 2.5 %). Source: Good, Permutation, Parametric and Bootstrap Tests of
/// Hypotheses (3rd ed.), 3.2. The test assumes that processes are exchangeable if the builds are equally fast, so run A
/// and B in random order. If A and B alternate strictly, the test rejects in less than 5 % of cases.
struct TimeRatio {
  double ratio = kMissing, low = kMissing, high = kMissing, p = kMissing;
  std::size_t processes_a = 0, processes_b = 0;
  bool enough() const { return processes_a >= kMinProcesses && processes_b >= kMinProcesses; }
  /// True if no difference is shown: too few processes, or the interval contains 1.
  bool noise() const { return !(low > 1) && !(high < 1); }
};

/// `a`, `b`: frame time [s] of each process, positive. Throws Error if a side has more than kMaxProcesses.
TimeRatio compare_times(const std::vector<double>& a, const std::vector<double>& b);

/// Frame times [s] of one run, one per process with trials: median over the trials of their mean frame time.
std::vector<double> process_times(const std::vector<const RunRecord*>&);

/// Whether the processes of the two sides alternated enough, by the start of their trials: for m and n processes at
/// least m n/(m + n) changes of side, half the mean of a random order. Otherwise a drift of the machine would count as
/// a difference of the builds. True if a start is unknown.
bool in_turns(const std::vector<const RunRecord*>& a, const std::vector<const RunRecord*>& b);

/// Ordered from good to bad; a run gets the worst of its findings. Changed: two builds differ (neither is a baseline).
enum class Verdict { Same, New, Improved, Changed, Failed };

const char* word_for(Verdict);

/// One quantity that differs from the baseline.
struct Finding {
  Verdict verdict = Verdict::Same;
  std::string quantity, baseline, found;
  std::string allowed;  ///< "≤ 0.0036"; empty if only the baseline value is allowed
  std::string message;  ///< explanation in addition to the values; may be empty

  std::string sentence() const;
};

struct CheckedRun {
  RunKey key;
  std::vector<Finding> findings = {};
  TimeRatio time = {};                              ///< set only if two builds are compared
  double time_a_s = kMissing, time_b_s = kMissing;  ///< median over the processes of each side
  bool in_turns = true;                             ///< result of the function in_turns
  std::string marks = {};  ///< kinds of conditions that differ and were allowed: "scene, machine"

  Verdict verdict() const;
  /// "noise", "faster", "slower", or the reason why there is no statement about times.
  std::string time_verdict() const;
  /// One line per finding whose verdict `is` accepts.
  std::string sentences(const std::function<bool(Verdict)>& is) const;
};

struct Checked {
  std::vector<CheckedRun> runs;               ///< every run of the baseline or the results, sorted by key
  DifferingRuns differing = DifferingRuns();  ///< conditions that differ from the baseline's and were allowed

  std::size_t count(Verdict) const;
  bool passed() const { return count(Verdict::Failed) == 0; }
};

/// Faults of the motion in the record's file; empty if it has none, or if the record was not read from a file.
std::vector<Finding> motion_findings(const RunRecord&);

/// Differences of `record` from its baseline (outcome, stages, scalars with a regression rule), trials that repeat
/// another trial, and faults of the stored motion (results/store.hpp). If the outcome differs, stages and scalars are
/// not compared. Throws Error if the record's scene has no cloth size.
std::vector<Finding> compare_run(const BaselineRun&, const RunRecord& record);

/// Differences of two builds' results of one run: outcome, stages, every machine-independent scalar (relative tolerance
/// 1e-9) and, if any differs, the maximum distance between the motions divided by the longer side.
std::vector<Finding> compare_records(const RunRecord& a, const RunRecord& b);

/// One element per process: the runs of its folder.
using Processes = std::vector<std::vector<RunRecord>>;

/// Compares two builds run by run: results of each side's first process, times of all processes. A's runs come first,
/// then the runs that only B has. Throws Error if a process has a run twice. Throws Error if a condition whose kind is
/// not in `allowed` differs within a pair of runs, or between the processes of a side.
Checked compare_processes(const Processes& a, const Processes& b, const std::vector<std::string>& allowed = {});

/// Compares results with a baseline. A run of the baseline or a planned run fails if it has no result. A run that is
/// not in the baseline is new. Throws Error if the results have a run twice, or if a condition differs from the
/// baseline's and its kind is not in `allowed`.
Checked check_runs(const Baseline&, const std::vector<RunRecord>&, const std::vector<std::string>& allowed = {});

struct Updated {
  Baseline baseline;
  std::vector<CheckedRun> changes;            ///< runs with changes beyond tolerance, from `compare_run`
  std::vector<RunKey> removed;                ///< runs without a result
  std::size_t within_slack = 0;               ///< runs with changed values, all within tolerance
  DifferingRuns differing = DifferingRuns();  ///< conditions that differ from the old baseline's
};

/// The baseline made from the results. Throws Error if there are no results, a run is listed twice, a planned run has
/// no result, or the motion in a file is faulty.
Updated update_baseline(const Baseline& old, const std::vector<RunRecord>&);

/// A table of failures, improvements and new runs, explanations below it, and the overall verdict in one line.
std::string check_text(const Checked&, const std::string& baseline_file);
nlohmann::json check_json(const Checked&, const std::string& baseline_file);

/// The changes by --update: one line per run, and a summary line.
std::string update_text(const Updated&, const std::string& baseline_file);
nlohmann::json update_json(const Updated&, const std::string& baseline_file);

/// Times and results of two builds as tables and JSON.
std::string comparison_text(const Checked&);
nlohmann::json comparison_json(const Checked&);

/// JUnit XML for CI servers: one test case per run (class = scene, name = solver and setting), with a <failure> if it
/// failed. Improvements and new runs are in <system-out>. Characters that XML 1.0 or UTF-8 forbids are replaced.
std::string junit_xml(const Checked&);

/// One line of JSON: commit and date of the first run that was made, the study's command, and values of each run.
std::string log_line(const std::vector<RunRecord>&, const std::string& command);

/// One GitHub Actions command per failure, which shows the failure at the top of the job.
std::string github_annotations(const Checked&);

}  // namespace clothbench
