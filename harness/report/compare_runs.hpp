#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// Ratio of the frame times of runs B and A, estimated from their trials. `ratio`: Hodges-Lehmann estimator, the median
/// of all pairwise ratios B/A. `low`, `high`: its confidence interval at the lowest possible level of at least 95 %.
/// `p`: two-sided, by the Mann-Whitney U test (exact; ties count half). Hollander, Wolfe, Chicken, Nonparametric
/// Statistical Methods (3rd ed.), 4.1 to 4.3.
struct TimeRatio {
  double ratio = kMissing, low = kMissing, high = kMissing, p = kMissing;
  double level = kMissing;  ///< of the interval; below 0.95 if there are too few trials
  /// True if the difference is not significant: too few trials, p above 5 %, or an interval that contains 1.
  bool noise() const { return !(p <= 0.05) || !(level >= 0.95) || (low <= 1 && high >= 1); }
};

/// `a`, `b`: mean frame time of each trial, positive; at most 40 trials each.
TimeRatio compare_times(const std::vector<double>& a, const std::vector<double>& b);

/// A run that is in both results, or in one (the other pointer is null then).
struct ComparedRun {
  std::string name;
  const RunRecord *a = nullptr, *b = nullptr;
  TimeRatio time = {};
  struct Change {
    std::string name;
    double a = kMissing, b = kMissing;
  };
  std::vector<Change> metrics =
      {};  ///< summary values that do not depend on the machine and differ by more than 1e-9 of their size
  struct Versions {
    std::string metric;
    int a = 1, b = 1;
  };
  std::vector<Versions> versions = {};  ///< metrics whose rule versions differ between the two; these are not compared
  std::string outcome = {};             ///< "ok → diverged (F1)", empty if it is the same
  /// Greatest distance between the two motions over the longer side (relation "before" of pairs.hpp); measured only if
  /// a value of the result differs, since positions are read from the files for it.
  double apart = kMissing;
};

/// Matches runs by name, in the order of A, then those that only B has. The records must outlive the result.
std::vector<ComparedRun> compare_runs(const std::vector<RunRecord>& a, const std::vector<RunRecord>& b);

std::vector<Table> comparison_tables(const std::vector<ComparedRun>&);
nlohmann::json comparison_json(const std::vector<ComparedRun>&);

/// Input of tools that plot results per commit (github-action-benchmark, customSmallerIsBetter): name, unit, value,
/// range and extra of every time and error.
nlohmann::json history_json(const std::vector<RunRecord>&);

}  // namespace clothbench
