#pragma once
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

struct IsotropicModuli {
  double E;   ///< over the Y that the scene states
  double nu;  ///< Poisson's ratio
};

/// Moduli of a flat triangle mesh that hangs along axis_u by its least u and has come to rest at `position` [m], xyz
/// interleaved. They are those whose exact displacement, along u (p/E) (L u - u^2/2 - nu v^2/2) and across it
/// -nu (p/E) (L - u) v, with p = density times gravity and v from the middle, is nearest to that of the vertices
/// between 0.4 L and 0.9 L, by least squares and but for motions of the whole. NaN without enough of them, or if the
/// sheet is not longer than it was.
IsotropicModuli hanging_moduli(const Scene&, const std::vector<double>& position);

}  // namespace clothbench
