#pragma once
#include <string>
#include <vector>

#include "clothbench/record.hpp"

namespace clothbench {

/// Names of the summary values that violate a bound of the run's scene; "outcome" if the run did not end as it should.
std::vector<std::string> violated_bounds(const RunRecord&);

inline constexpr const char* kNoVerdict = "–";

/// Verdict on a run: "pass", "fail", "not measured"; kNoVerdict if there are no bounds;
/// "ignored" if the bounds hold but the scene has contact and the solver ignores all of it, which
/// proves nothing. If the run did not end well, its ending. Tables, consoles, JSON and the page print this.
std::string verdict(const RunRecord&);

/// Bounds that the run's scene sets on a value, and the check of its motion; only `"outcome": "ok"` is none.
std::size_t bounds_of(const RunRecord&);

/// Counted by `verdict`, of the runs whose scene has a bound. Missing runs are not counted.
struct VerdictCounts {
  std::size_t runs = 0, passed = 0, ignored = 0, unsupported = 0, not_measured = 0;
  /// Failed a bound, or did not end well.
  std::size_t failed() const { return runs - passed - ignored - unsupported - not_measured; }
  /// "3 of 5 runs passed, 1 failed, 1 unsupported"; what there is none of is left out.
  std::string text() const;
  void add(const RunRecord&);
};

/// The one count of passed runs: consoles, tables and JSON take it from here.
VerdictCounts count_verdicts(const std::vector<RunRecord>&);

}  // namespace clothbench
