#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// What two runs' trials say about one time: `ratio` is that of B to A (Hodges-Lehmann: the median of all pairwise
/// ratios), `low` and `high` bound it at 95 % or as near above as the numbers of trials allow, `p` is two-sided by Mann
/// and Whitney's U test (exact; ties count half). Hollander, Wolfe, Chicken, Nonparametric Statistical Methods (3rd
/// ed.), 4.1 to 4.3.
struct TimeRatio {
  double ratio = kMissing, low = kMissing, high = kMissing, p = kMissing;
  double level = kMissing;  ///< of the interval; below 0.95 where there are too few trials for that
  /// Neither faster nor slower can be said: too few trials, p above 5 %, or an interval that holds 1.
  bool noise() const { return !(p <= 0.05) || !(level >= 0.95) || (low <= 1 && high >= 1); }
};

/// Each value one trial's mean time of a frame; positive, at most 40 on either side.
TimeRatio compare_times(const std::vector<double>& a, const std::vector<double>& b);

/// A run of both results, or of one (then the other is null).
struct ComparedRun {
  std::string name;
  const RunRecord *a = nullptr, *b = nullptr;
  TimeRatio time;
  struct Change {
    std::string name;
    double a = kMissing, b = kMissing;
  };
  std::vector<Change>
      metrics;  ///< summary values that do not depend on the machine and differ by more than 1e-9 of their size
  struct Versions {
    std::string metric;
    int a = 1, b = 1;
  };
  std::vector<Versions>
      versions;         ///< metrics that the two were measured by under different rules: nothing of them is compared
  std::string outcome;  ///< "ok → diverged (F1)", empty if it is the same
};

/// Runs by name, in the order of A and then what only B has. The records must outlive it.
std::vector<ComparedRun> compare_runs(const std::vector<RunRecord>& a, const std::vector<RunRecord>& b);

std::vector<Table> comparison_tables(const std::vector<ComparedRun>&);
nlohmann::json comparison_json(const std::vector<ComparedRun>&);

/// What chart-per-commit tools read, smaller is better: name, unit, value, range and extra of every time and error.
/// github-action-benchmark, customSmallerIsBetter.
nlohmann::json history_json(const std::vector<RunRecord>&);

}  // namespace clothbench
