// Triangles of constant strain against the energy of an isotropic sheet.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "reference/mesh_energy.hpp"

namespace clothbench {
namespace {

/// Energy over area under the strain (xx, yy, xy): plane stress, Poisson's ratio 1/3.
double of_sheet(double Y, const Eigen::Vector3d& e) {
  const double nu = reference::kMeshPoissonRatio, trace = e[0] + e[1];
  return Y / (2 * (1 - nu * nu)) * (nu * trace * trace + (1 - nu) * (e[0] * e[0] + e[1] * e[1] + 2 * e[2] * e[2]));
}

TEST(MeshMembrane, ATriangleHasTheEnergyOfAnIsotropicSheetWhereverItLies) {
  const double Y = 700;
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
    const Eigen::Vector2d p = flat[1] - flat[0], q = flat[2] - flat[0];
    const double area = std::abs(p.x() * q.y() - p.y() * q.x()) / 2;
    const Eigen::Matrix3d K = reference::triangle_compliance(corners, Y).inverse();
    for (const Eigen::Vector3d& e : {Eigen::Vector3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}, {0.2, -0.4, 0.3}}) {
      Eigen::Vector3d d;
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector2d s = flat[static_cast<std::size_t>((k + 1) % 3)] - flat[static_cast<std::size_t>(k)];
        d[k] = (e[0] * s.x() * s.x() + e[1] * s.y() * s.y() + 2 * e[2] * s.x() * s.y()) / s.norm();
      }
      EXPECT_NEAR(0.5 * d.dot(K * d) / (area * of_sheet(Y, e)), 1, 1e-9);
    }
  }
}

TEST(MeshMembrane, EquilateralTrianglesAreSprings) {
  const Eigen::Matrix3d S = reference::triangle_compliance({{{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}}}, 100);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(S(i, j), i == j ? 4 / (100 * std::sqrt(3.0)) : 0, 1e-12);
}

}  // namespace
}  // namespace clothbench
