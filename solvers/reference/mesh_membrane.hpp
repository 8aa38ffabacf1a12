#pragma once
#include <Eigen/Core>
#include <array>

#include "clothbench/scene.hpp"

namespace clothbench::reference {

/// Poisson's ratio of a triangle mesh: that of the springs of grids, which equilateral triangles then are.
inline constexpr double kMeshPoissonRatio = 1.0 / 3;

/// Compliance S [m/N] of a triangle of constant strain: S t are the elongations of the edges 0-1, 1-2 and 2-0 under the
/// tensions t [N] in them. Its energy 1/2 d' S^-1 d in the elongations d is, for small d, that of an isotropic sheet of
/// plane stress, of `stiffness_N_per_m` and Poisson's ratio 1/3 (Delingette, "Triangular springs for modeling nonlinear
/// membranes", IEEE TVCG 14, 2008, has it for squared lengths). `corners` are at rest and not on one line.
Eigen::Matrix3d triangle_compliance(const std::array<Vec3, 3>& corners, double stiffness_N_per_m);

}  // namespace clothbench::reference
