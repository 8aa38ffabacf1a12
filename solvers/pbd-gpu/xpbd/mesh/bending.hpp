#pragma once
#include <cstdint>
#include <vector>

#include "xpbd/constraints.hpp"

namespace clothbench::pbd_gpu {

/// Matrix K [N/m] of the bending energy 1/2 (x'Kx + y'Ky + z'Kz) of a triangle mesh that is flat at rest across every
/// edge, without its diagonal: rows sum to 0.
struct BendingMatrix {
  std::vector<std::uint32_t> first;    ///< entry of each vertex's row; one more than vertices
  std::vector<std::uint32_t> columns;  ///< of entries, ascending in a row
  std::vector<double> stiffness;       ///< of entries [N/m]
  double max_per_s2 = 0;  ///< at least the maximum eigenvalue of (diagonal of masses)^-1 K [1/s^2], nothing held
};

/// Morley's primitive (1968): second derivatives are constant in a triangle, from positions along its edges and
/// derivatives across them. A derivative is taken from the weighted least-squares quadratic through the vertices of the
/// triangles near its edge, so that there are no unknowns but positions. Exact for quadratic deflections on any mesh,
/// in energy and in force. A triangle whose vertices are all pinned is a clamp: derivatives across its edges are its
/// own. `reference` solves for the derivatives instead.
BendingMatrix bending_matrix(const Scene&);

/// Chebyshev's iteration for (M + h^2 K) x = M y: count of iterations that leaves a thousandth of the way from y to x,
/// 2 to 1000, from the maximum eigenvalue of h^2 M^-1 K.
std::uint32_t bending_iterations(double largest);

/// Data of the kernel. Rows shorter than the slice's longest are padded with entries of stiffness 0 to themselves.
SlicedRows<BendingEntry> bending_table(const BendingMatrix&);

}  // namespace clothbench::pbd_gpu
