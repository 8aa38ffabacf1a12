#include "mesh_membrane.hpp"

#include <Eigen/Geometry>

namespace clothbench::reference {

Eigen::Matrix3d triangle_compliance(const std::array<Vec3, 3>& corners, double stiffness_N_per_m) {
  constexpr double nu = kMeshPoissonRatio;
  std::array<Eigen::Vector3d, 3> p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = Eigen::Vector3d::Map(corners[k].data());
  const Eigen::Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]), u = (p[1] - p[0]).normalized(),
                        v = normal.normalized().cross(u);
  // Elongations of the edges from the strains xx, yy and 2 xy, which are constant.
  Eigen::Matrix3d from_strain;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d e = p[static_cast<std::size_t>((k + 1) % 3)] - p[static_cast<std::size_t>(k)];
    const double x = u.dot(e), y = v.dot(e);
    from_strain.row(k) = Eigen::RowVector3d(x * x, y * y, x * y) / e.norm();
  }
  Eigen::Matrix3d of_material;
  of_material << 1, -nu, 0, -nu, 1, 0, 0, 0, 2 * (1 + nu);
  return from_strain * of_material * from_strain.transpose() / (stiffness_N_per_m * normal.norm() / 2);
}

}  // namespace clothbench::reference
