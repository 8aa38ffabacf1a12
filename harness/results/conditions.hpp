#pragma once
#include <string>
#include <vector>

#include "clothbench/record.hpp"

namespace clothbench {

/// A condition that must be equal in two runs that are compared. `kind` is the word for `--allow`; a kind has several
/// conditions.
struct Condition {
  std::string kind, what, value;  ///< `value`: "–" if the run does not state it
};

/// The kinds, in order: "scene", "machine", "device", "precision", "length", "trials", "order".
const std::vector<std::string>& condition_kinds();

/// The kind of a condition of results ("GPU" is of "device").
std::string kind_of_condition(const std::string& what);

/// All conditions of a run, in the order of the kinds. A run that did not end well has no "length", since it is the
/// result that is shorter; one without timed trials has no "trials".
std::vector<Condition> conditions_of(const RunRecord&);

/// Those that results hang on and times do not: all but the machine, the driver and the trials.
std::vector<Condition> conditions_of_results(const RunRecord&);

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
  /// A line for each allowed difference, which marks an output; empty if there is none.
  std::string marks() const;
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

}  // namespace clothbench
