#pragma once
#include <map>
#include <string>

#include "clothbench/record.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// Result of checking a run against what its scene expects: the `expect` of its file, the bounds of its exact solution
/// (metrics/exact_bound.hpp), and stability grade 0 if it has a stability block. The last two imply outcome "ok". The
/// motion check applies to every run whose summary has its statistics.
struct Verdict {
  /// "pass"; "fail: " and every broken expectation with its value and bound; "not measured" if the accuracy pass is
  /// shorter than the scene without having failed, or if this build cannot measure the scene's contact; "" if the scene
  /// expects nothing and the motion was not checked.
  std::string text;
  /// "expect.<name>" -> 1 pass, 0 fail, NaN not measured; for the summary.
  std::map<std::string, double> scalars;
};

/// A value that is NaN or missing breaks its expectation.
Verdict judge(const Scene&, const Outcome&, const AccuracyPass&, const std::map<std::string, double>& summary);

}  // namespace clothbench
