#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <cstdint>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::reference {

/// Matrix K [N/m], vertices x vertices, of the bending energy 1/2 (x'Kx + y'Ky + z'Kz) of a triangle mesh that is flat
/// at rest across every edge: 1/2 B times the integral of the squared second derivatives of the position (Frobenius
/// norm; for a sheet that does not stretch, the sum of the squared principal curvatures, so a strip has rigidity B in
/// every direction).
///
/// Morley's element ("The triangular equilibrium element in the solution of plate bending problems", Aeronautical
/// Quarterly 19, 1968): second derivatives are constant in a triangle, and the derivative across each edge is an
/// unknown at its middle. These unknowns have no mass; K remains after their elimination. It is exact for quadratic
/// deflections on any mesh, in energy and in force, and converges with order 2.
///
/// A triangle with all vertices in `pinned` (ascending) is a clamp: its plane sets derivatives across its edges.
/// Entries below 1e-13 of the maximum are omitted. Needs one factorisation and one solve per vertex.
Eigen::SparseMatrix<double> bending_matrix(const ClothMesh&, double rigidity_N_m,
                                           const std::vector<std::uint32_t>& pinned);

/// Poisson's ratio of triangle meshes and of grid springs. With it an equilateral triangle is equal to three springs.
inline constexpr double kMeshPoissonRatio = 1.0 / 3;

/// Compliance S [m/N] of a triangle of constant strain: S t are the elongations of the edges 0-1, 1-2 and 2-0 under the
/// tensions t [N] in them. Its energy 1/2 d' S^-1 d in the elongations d is, for small d, the energy of an isotropic
/// sheet in plane stress with `stiffness_N_per_m` and Poisson's ratio 1/3 (Delingette, "Triangular springs for modeling
/// nonlinear membranes", IEEE TVCG 14, 2008, for squared lengths). `corners`: at rest, not on one line.
Eigen::Matrix3d triangle_compliance(const std::array<Vec3, 3>& corners, double stiffness_N_per_m);

}  // namespace clothbench::reference
