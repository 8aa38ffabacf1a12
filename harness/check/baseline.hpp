#pragma once
#include <compare>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "clothbench/record.hpp"
#include "metrics/registry.hpp"

namespace clothbench {

/// A condition that must be equal in two runs that are compared. `kind` is the word for `--allow`; a kind has several
/// conditions.
struct Condition {
  std::string kind, what, value;  ///< `value`: "–" if the run does not state it
};

/// The kinds, in order: "scene", "machine", "device", "precision", "length", "trials", "order".
const std::vector<std::string>& condition_kinds();

/// All conditions of a run, in the order of the kinds. A run that did not end well has no "length", since it is the
/// result that is shorter; one without timed trials has no "trials".
std::vector<Condition> conditions_of(const RunRecord&);

struct ConditionDifference {
  std::string kind, what, a, b;
  bool operator==(const ConditionDifference&) const = default;
};

/// Conditions that both have with different values.
std::vector<ConditionDifference> differences(const std::vector<Condition>& a, const std::vector<Condition>& b);

/// Keys of the two completed scenes that differ, with both values: "/cloth/grid/0: 8, 24"; at most four, then their
/// number.
std::string scene_difference(const RunRecord& a, const RunRecord& b);

/// Differences of several runs, each with the runs that have it.
class DifferingRuns {
 public:
  explicit DifferingRuns(std::vector<std::string> allowed = {}) : allowed_(std::move(allowed)) {}

  void add(const std::string& run, const ConditionDifference&);
  /// Throws Error that names every difference that is not allowed, with both values. `a`, `b`: what the sides are
  /// called.
  void refuse(const std::string& a, const std::string& b) const;
  /// A line for each difference, which marks an output and begins with `what`; empty if there is none.
  std::string marks(const std::string& what = "Compared although it differs, by --allow") const;
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
  // Not <=>: strings have none yet in the libc++ of Android's NDK r25.
  bool operator==(const RunKey&) const = default;
  bool operator<(const RunKey& o) const {
    return std::tie(scene, solver, setting) < std::tie(o.scene, o.solver, o.setting);
  }

  std::string file_name() const;  ///< "<scene>__<solver>__<setting>", as the result file is called
};

/// The part of a run that does not depend on the machine.
struct BaselineRun {
  RunKey key;
  std::vector<Condition> conditions;  ///< under which its values hold, scene included, but no machine, driver or trials
  std::string status, klass;
  int failed_frame = -1;
  std::vector<std::string> stages;        ///< "<name> (<feature>, <feature>)" in order
  std::map<std::string, double> scalars;  ///< only gated ones; NaN or absent = not measured
};

struct Baseline {
  std::vector<BaselineRun> runs;  ///< sorted by key, no key twice
};

/// The part of a result that is gated. A scalar that is not finite counts as not measured and is left out.
BaselineRun gated_part(const RunRecord&);
/// As gated_part(), but with every scalar that does not depend on the machine.
BaselineRun whole_part(const RunRecord&);

/// Reads and checks a baseline. Throws Error with file and JSON pointer (line and column if the text is not JSON) for a
/// key that is unknown or missing, a scalar that has no gate, or a run that is listed twice.
Baseline read_baseline(const std::filesystem::path&);

/// The file's text: one line per value, sorted; numbers read back exactly.
std::string baseline_text(const Baseline&);

/// results/baselines/baseline.schema.json, compiled in.
extern const char* const kBaselineSchema;

/// Rule that compares a summary scalar with its baseline, from the metric registry; nullptr if it is not compared. The
/// result of a bound has no slack.
const Gate* find_gate(const std::string& name);

/// Whether it is the result of a bound, 1 pass or 0 fail: fail after pass fails, pass after fail is an improvement.
bool is_verdict(const std::string& name);

std::vector<std::string> gated_names();

/// Allowed deviation from `baseline` in either direction [unit of the scalar]. `length_m`: shorter side of the cloth.
double slack(const Gate&, double baseline, double length_m);

/// "0.01 L + 10 %; none at 0", where L is the shorter side.
std::string slack_text(const Gate&);

}  // namespace clothbench
