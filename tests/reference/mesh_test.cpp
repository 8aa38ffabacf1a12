// Bending of triangle meshes (Morley's element) against beams, on random meshes with fixed seeds.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "reference/mesh_energy.hpp"
#include "strips.hpp"

namespace clothbench {
namespace {

TEST(MeshBending, ACantileverIsThatOfABeamOnDrawnMeshesWithOrderTwo) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const auto error = [&](int cells) {
      const Scene s = clamped_strip(cells, 0.06 * seed, seed, 2e-3);  // up to 0.36 of a cell
      const Eigen::MatrixXd K = reference::bending_matrix(*s.cloth.mesh, 2e-3, s.pins.vertices);
      return std::abs(tip_over_beam(s, cells, K) - 1);
    };
    const double coarse = error(8), fine = error(24);
    EXPECT_LE(fine, 0.005) << "seed " << seed;
    EXPECT_GE(std::log(coarse / fine) / std::log(3), 1.8) << "seed " << seed;
  }
}

TEST(MeshBending, RigidMotionsAndPlanesCostNothing) {
  const ClothMesh mesh = drawn_mesh({1, 0.25, 12, 0.5, 0.3, 7});
  const Eigen::MatrixXd K = reference::bending_matrix(mesh, 1, {});
  EXPECT_LE((K - K.transpose()).cwiseAbs().maxCoeff(), 1e-12 * K.cwiseAbs().maxCoeff());
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::VectorXd plane(K.rows());
    for (Eigen::Index v = 0; v < K.rows(); ++v)
      plane[v] = axis == 2 ? 1 : mesh.vertices[static_cast<std::size_t>(v)][static_cast<std::size_t>(axis)];
    EXPECT_LE((K * plane).cwiseAbs().maxCoeff(), 1e-9 * K.cwiseAbs().maxCoeff());
  }
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
  EXPECT_GE(values[0], -1e-9 * values[K.rows() - 1]);
  EXPECT_GE(values[3], 1e-6 * values[K.rows() - 1]) << "no other motion is free: there are no spurious modes";
}

/// Damped to rest under a small load.
TEST(MeshBending, TheReferenceSolverComesToRestAsTheBeam) {
  Scene s = with_damping(clamped_strip(12, 0.25, 3, 0.02), 6);
  s.cloth.areal_density_kg_per_m2 = 0.1;
  s.gravity_m_per_s2 = {0, -0.1, 0};
  s.time = {10, 6};
  const SolverEntry& e = find_solver("reference");
  EXPECT_NEAR(tip_over_beam_at_end(s, 12, *e.make(complete_settings(e.info, {{"substeps", 2}}), {})), 1, 0.03);
}

TEST(MeshMembrane, ATriangleHasTheEnergyOfAnIsotropicSheetWhereverItLies) {
  Eigen::Matrix3d turned;
  turned = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -0.5).normalized());
  for (const auto& flat : {std::array<Eigen::Vector2d, 3>{{{0, 0}, {1, 0}, {0.5, 0.9}}},
                           {{{0, 0}, {0.3, 0.1}, {0, 0.4}}},
                           {{{0.1, 0.2}, {1.1, 0.1}, {-0.3, 0.6}}}}) {
    std::array<Vec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d at = turned * Eigen::Vector3d(flat[k].x(), flat[k].y(), 0.4);
      corners[k] = {at.x(), at.y(), at.z()};
    }
    const Eigen::Matrix3d K = reference::triangle_compliance(corners, 700).inverse();
    for (const Eigen::Vector3d& e : {Eigen::Vector3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}, {0.2, -0.4, 0.3}})
      EXPECT_NEAR(energy_over_sheet(flat, K, 700, e), 1, 1e-9);
  }
}

TEST(MeshMembrane, EquilateralTrianglesAreSprings) {
  const Eigen::Matrix3d S = reference::triangle_compliance({{{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}}}, 100);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(S(i, j), i == j ? 4 / (100 * std::sqrt(3.0)) : 0, 1e-12);
}

}  // namespace
}  // namespace clothbench
