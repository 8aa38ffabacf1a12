// Bending of triangle meshes in xpbd: the matrix against beams, and the kernel against double precision.
#include "gpu_fixture.hpp"
#include "strips.hpp"
#include "xpbd/mesh/matrices.hpp"

namespace clothbench::pbd_gpu {
namespace {

Eigen::MatrixXd dense(const BendingMatrix& K) {
  const auto n = static_cast<Eigen::Index>(K.first.size() - 1);
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (std::uint32_t e = K.first[static_cast<std::size_t>(i)]; e < K.first[static_cast<std::size_t>(i) + 1]; ++e) {
      out(i, K.columns[e]) += K.stiffness[e];
      out(i, i) -= K.stiffness[e];
    }
  return out;
}

TEST(MeshBendingMatrix, ACantileverIsThatOfABeamOnDrawnMeshes) {
  for (unsigned seed = 1; seed <= 6; ++seed)
    for (const auto& [cells, tolerance] : {std::pair{8, 0.03}, {24, 0.005}}) {
      const Scene s = clamped_strip(cells, 0.06 * (seed - 1), seed, 2e-3);  // up to 0.3 of a cell
      EXPECT_NEAR(tip_over_beam(s, cells, dense(bending_matrix(s))), 1, tolerance) << "seed " << seed;
    }
}

TEST(MeshBendingMatrix, ItsBoundIsAboveTheGreatestEigenvalueAndNotMuch) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Scene s = clamped_strip(12, 0.12 * (seed - 1), seed, 1e-3);
    const BendingMatrix K = bending_matrix(s);
    const Eigen::VectorXd per = masses_of(s).cwiseSqrt().cwiseInverse();
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(per.asDiagonal() * dense(K) * per.asDiagonal()).eigenvalues();
    EXPECT_GE(K.max_per_s2, values[values.size() - 1]);
    EXPECT_LE(K.max_per_s2, 2 * values[values.size() - 1]);
  }
}

using MeshBending = Gpu;

/// With almost no link stiffness, M (x - y) = -h^2 K x remains, y being the prediction.
TEST_F(MeshBending, OneSubstepIsTheImplicitStepInDoublePrecision) {
  for (const double B : {1e-5, 3e-3, 0.5}) {
    Scene s = clamped_strip(12, 0.25, 4, B);
    s.material.membrane_stiffness_N_per_m = 1e-12;
    const double fall = 9.81 * s.time.dt() * s.time.dt();
    const auto solver = make("xpbd", {{"substeps", 1}, {"time_order", 1}});
    solver->load(s);
    const std::vector<double> start = initial_positions(s);
    const std::vector<Eigen::Index> free = free_vertices(s);
    const Eigen::VectorXd mass = masses_of(s)(free);
    Eigen::MatrixXd A = s.time.dt() * s.time.dt() * dense(bending_matrix(s))(free, free);
    A.diagonal() += mass;
    const Eigen::VectorXd way = A.ldlt().solve(-fall * mass);
    const ClothState end = after(*solver, s, 1);
    for (std::size_t k = 0; k < free.size(); ++k) {
      const auto at = static_cast<std::size_t>(3 * free[k] + 1);
      EXPECT_NEAR(end.position[at] - start[at], way[static_cast<Eigen::Index>(k)], 2e-3 * fall) << "B " << B;
    }
  }
}

TEST_F(MeshBending, ACantileverComesToRestAsABeam) {
  Scene s = with_damping(clamped_strip(12, 0.24, 2, 0.2), 12);
  s.cloth.areal_density_kg_per_m2 = 0.1;
  s.gravity_m_per_s2 = {0, -1, 0};
  s.time = {30, 1.2};
  EXPECT_NEAR(tip_over_beam_at_end(s, 12, *make("xpbd", {{"substeps", 8}})), 1, 0.01);
}

}  // namespace
}  // namespace clothbench::pbd_gpu
