#pragma once
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// A result that needs several runs of one solver at one setting, from their pairs (pairs.hpp): "even-frames", "scale",
/// "resolution" (not judged, since iterative solvers get softer with resolution), "repeat" and the spread by "seed".
struct AcrossRuns {
  std::string case_name, solver, setting, figure, text;  ///< figure: what `value` is
  double value = kMissing, bound = kMissing;             ///< no bound: reported, not judged
  bool judged() const { return bound == bound; }
  bool passed() const { return value <= bound; }
};

/// Compares the runs of a stability study; reads positions from their files. A comparison is left out if the run that
/// it compares with is missing or did not end well. If another of its runs did not, a judged value is infinity.
std::vector<AcrossRuns> across_runs(const std::vector<RunRecord>& runs);

Table across_table(const std::vector<AcrossRuns>&);
std::string across_csv(const std::vector<AcrossRuns>&);

}  // namespace clothbench
