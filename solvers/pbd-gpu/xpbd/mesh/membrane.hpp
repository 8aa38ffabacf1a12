#pragma once

#include "common/gpu_types.h"
#include "xpbd/lines/line_layout.hpp"

namespace clothbench::pbd_gpu {

/// Stiffness [N/m] of a triangle of constant strain in the elongations d of its edges 0-1, 1-2 and 2-0; its energy is
/// 1/2 sum K_jk d_j d_k. For small d that is an isotropic sheet of plane stress and Poisson's ratio 1/3.
struct TriangleStiffness {
  double rest_m[3];     ///< lengths
  double along_N_m[3];  ///< K_00, K_11, K_22
  double cross_N_m[3];  ///< K_01, K_12, K_20
};
/// Delingette (2008), "Triangular springs for modeling nonlinear membranes", with lengths instead of their squares.
TriangleStiffness triangle_stiffness(const ClothMesh&, std::size_t triangle, double Y_N_per_m);

/// At least the maximum eigenvalue [1/s^2] of (diagonal of masses)^-1 K, K the matrix of all triangles at rest,
/// however they are turned, times a factor that leaves room for their deformation. The kernel keeps each triangle's
/// matrix within that room.
double membrane_bound(const Scene&);

/// Whether an elastic mesh is solved by triangles, all at once; else chains of springs along its edges solve it.
FeatureDecision membrane_decision(const Scene&, const nlohmann::json& settings);

/// Input of the kernel: the triangles around each vertex, turned so that it comes first. Rows shorter than the
/// slice's longest are padded with entries whose `a` is CHAIN_NO_VERTEX.
SlicedRows<MembraneCorner> membrane_table(const Scene&);

}  // namespace clothbench::pbd_gpu
