#pragma once
#include <string>
#include <vector>

namespace clothbench::truth {

/// How far a run may be from the exact solution of its reference case and still be right. The error of the mesh and of
/// float32 positions come on top (metrics/exact_bound.hpp).
struct Tolerance {
  std::string reference_case;
  /// Share of the exact motion: a cloth that keeps its start has the error 1. It holds for every parameter, and a
  /// motion that is too small fails by the same amount as one that is too large.
  double of_motion = 0;
  double at_rest = 0;  ///< share of the longer side, for cloth that the exact solution does not move; 0: always moves
  std::string why;
};

/// One entry per reference case.
const std::vector<Tolerance>& tolerances();

/// Throws Error if there is none of that name.
const Tolerance& tolerance_of(const std::string& reference_case);

}  // namespace clothbench::truth
