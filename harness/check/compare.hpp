#pragma once
#include <string>
#include <vector>

#include "check/baseline.hpp"

namespace clothbench {

/// Ordered from good to bad; the verdict of a whole is the greatest of its parts'.
enum class Verdict { Same, New, Improved, Failed };

const char* word_for(Verdict);

/// One quantity that is not as in the baseline.
struct Finding {
  Verdict verdict = Verdict::Same;
  std::string quantity, baseline, found;
  std::string allowed;  ///< "≤ 0.0036"; empty where it is the baseline itself
  std::string message;  ///< what the values alone do not tell; may be empty

  std::string sentence() const;
};

struct CheckedRun {
  RunKey key;
  std::vector<Finding> findings;

  Verdict verdict() const;
};

struct Checked {
  std::vector<CheckedRun> runs;  ///< every run of baseline and results, sorted by key
  std::size_t other_assets =
      0;  ///< runs of the baseline left out because the results have the same run with other assets

  std::size_t count(Verdict) const;
  bool passed() const { return count(Verdict::Failed) == 0; }
};

/// A metric by whose rule baseline and result were not measured alike.
struct VersionDifference {
  std::string metric;
  int baseline, found;
};

/// Of the metrics behind scalars that both have.
std::vector<VersionDifference> version_differences(const BaselineRun& was, const BaselineRun& is);

/// What of `record` differs from its baseline: the scene, the outcome, the stages, the gated scalars; and whether one
/// of its trials repeats another. Where the scene or the outcome differ, the rest is not comparable and left out, and
/// so are scalars of a metric whose version differs. Throws Error if the record's scene has no cloth size.
std::vector<Finding> compare_run(const BaselineRun&, const RunRecord& record);

/// Holds results to a baseline. A run of the baseline without a result fails, unless the results have the run with
/// another kind of assets that the baseline also knows; so does a planned run without a result. A run that the
/// baseline does not have is new. Throws Error if a run stands twice among the results, or was measured by another
/// version of a metric's rule than the baseline's: no verdict is made of two rules.
Checked check_runs(const Baseline&, const std::vector<RunRecord>&);

struct Updated {
  Baseline baseline;
  std::vector<CheckedRun> changes;  ///< beyond slack, as `compare_run` tells them
  std::vector<RunKey> removed;      ///< had no result
  std::size_t within_slack = 0;     ///< runs with other values, all of them within slack
};

/// The baseline that the results make: their runs, and those of `old` that are there with other assets alone. Throws
/// Error if there is no result, a run stands twice, or a planned run has no result.
Updated update_baseline(const Baseline& old, const std::vector<RunRecord>&, BaselineOrigin);

}  // namespace clothbench
