#pragma once
#include <cstdint>
#include <vector>

#include "xpbd/constraints.hpp"
#include "xpbd/time/integrator.hpp"

namespace clothbench::pbd_gpu {

/// Matrix K [N/m] of the bending energy 1/2 (x'Kx + y'Ky + z'Kz) of a triangle mesh that is flat at rest across every
/// edge. The diagonal is not stored, because rows sum to 0.
struct BendingMatrix {
  std::vector<std::uint32_t> first;    ///< first entry of each vertex's row, then the number of entries
  std::vector<std::uint32_t> columns;  ///< column of each entry, ascending in a row
  std::vector<double> stiffness;       ///< value of each entry [N/m]
  double max_per_s2 = 0;  ///< upper bound of the eigenvalues of (diagonal of masses)^-1 K [1/s^2], without pins
};

/// Uses Morley's element (xpbd/mesh/README.md). Exact for quadratic deflections on any mesh, in energy and in force.
/// The solver `reference` solves for the derivatives across edges instead.
BendingMatrix bending_matrix(const Scene&);

/// Number of Chebyshev's iterations (2 to 1000) that reduce the error of (M + h^2 K) x = M y to a thousandth.
/// `largest`: upper bound of the eigenvalues of h^2 M^-1 K.
std::uint32_t bending_iterations(double largest);

/// Input of the kernel. Rows shorter than the slice's longest are padded with diagonal entries of stiffness 0.
SlicedRows<BendingEntry> bending_table(const BendingMatrix&);

/// Stiffness [N/m] of a triangle of constant strain in the elongations d of its edges 0-1, 1-2 and 2-0; its energy is
/// 1/2 sum K_jk d_j d_k. For small d that is an isotropic sheet in plane stress with Poisson's ratio 1/3.
struct TriangleStiffness {
  double rest_m[3];     ///< lengths
  double along_N_m[3];  ///< K_00, K_11, K_22
  double cross_N_m[3];  ///< K_01, K_12, K_20
};
/// Delingette (2008), "Triangular springs for modeling nonlinear membranes", with lengths instead of their squares.
TriangleStiffness triangle_stiffness(const ClothMesh&, std::size_t triangle, double Y_N_per_m);

/// Upper bound of the eigenvalues [1/s^2] of (diagonal of masses)^-1 K, K the matrix of all triangles at rest, at any
/// orientation, times a factor that leaves room for their deformation. The kernel scales a triangle's matrix down if it
/// exceeds that room.
double membrane_bound(const Scene&);

/// `substeps`, or up to twice as many where that allows a solve with triangles.
int substeps_for_membrane(const Scene&, int substeps);
/// Whether an elastic mesh is solved with triangles, all of them together; otherwise with springs along edge paths.
FeatureDecision membrane_decision(const Scene&, const nlohmann::json& settings);

/// Input of the kernel: the triangles around each vertex, with corners rotated so that the vertex comes first. Rows
/// shorter than the slice's longest are padded with entries whose `a` is CHAIN_NO_VERTEX.
SlicedRows<MembraneCorner> membrane_table(const Scene&);

}  // namespace clothbench::pbd_gpu
