#pragma once
#include "clothbench/record.hpp"
#include "metrics/truth_errors.hpp"

namespace clothbench {

/// Bounds on two scalars of a whole run of a scene with an exact solution: the distance of the positions (`truth_e2`)
/// and the error of the reference case's quantity (`truth_quantity_error`), both as the norm of a difference, so that
/// a value too small fails as one too large. Each is
///   tolerance * moved + mesh + rounding,
/// where `moved` is the same scalar of a cloth that keeps its start (where that is 0: the tolerance at rest), `mesh`
/// the part of it that a triangle mesh is off, and `rounding` what positions in float32 change.
struct ExactBound {
  double e2 = kMissing, quantity_error = kMissing;
};

/// The judge's scene is the one that was run, with drawn and overridden parameters. Throws Error if its reference case
/// has no tolerance (truth/reference_case.hpp).
ExactBound exact_bound(const TruthJudge&);

}  // namespace clothbench
