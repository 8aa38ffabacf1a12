#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/scene.hpp"
#include "clothbench/vector.hpp"

namespace clothbench::pbd_gpu {

struct IsotropicModuli {
  double E;   ///< over the Y that the scene states
  double nu;  ///< Poisson's ratio
};

/// Moduli of a flat triangle mesh that hangs along axis_u by its least u and has come to rest at `position` [m], xyz
/// interleaved. They are those whose exact displacement, along u (p/E) (L u - u^2/2 - nu v^2/2) and across it
/// -nu (p/E) (L - u) v, with p = density times gravity and v from the middle, is nearest to that of the vertices
/// between 0.4 L and 0.9 L, by least squares and but for motions of the whole. NaN without enough of them, or if the
/// sheet is not longer than it was.
inline IsotropicModuli hanging_moduli(const Scene& s, const std::vector<double>& position) {
  constexpr double kFirst = 0.4, kLast = 0.9;  // of the length: the held edge and the free one change the motion
  const std::vector<Vec3>& rest = s.cloth.mesh->vertices;
  const auto sides = [&](std::size_t k) {
    const auto [least, most] =
        std::minmax_element(rest.begin(), rest.end(), [k](const Vec3& a, const Vec3& b) { return a[k] < b[k]; });
    return std::pair((*least)[k], (*most)[k]);
  };
  const auto [u0, u1] = sides(0);
  const auto [v0, v1] = sides(1);
  const double L = u1 - u0, Y = *s.material.membrane_stiffness_N_per_m;
  const double p = s.cloth.areal_density_kg_per_m2 * dot(s.gravity_m_per_s2, s.cloth.axis_u);
  const std::vector<double> start = initial_positions(s);
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (rest[i][0] - u0 >= kFirst * L && rest[i][0] - u0 <= kLast * L) used.push_back(i);
  constexpr std::size_t kUnknowns = 4;
  if (used.size() <= kUnknowns) return {kMissing, kMissing};
  const auto n = static_cast<Eigen::Index>(used.size());
  Eigen::MatrixXd along(n, 4), across(n, 3);
  Eigen::VectorXd moved_u(n), moved_v(n);
  for (Eigen::Index row = 0; row < n; ++row) {
    const std::size_t i = used[static_cast<std::size_t>(row)];
    const double u = rest[i][0] - u0, v = rest[i][1] - (v0 + v1) / 2;
    const Vec3 moved = {position[3 * i] - start[3 * i], position[3 * i + 1] - start[3 * i + 1],
                        position[3 * i + 2] - start[3 * i + 2]};
    along.row(row) << 1, v, v * v, p / Y * (L * u - u * u / 2);
    across.row(row) << 1, u, -p / Y * (L - u) * v;
    moved_u[row] = dot(moved, s.cloth.axis_u);
    moved_v[row] = dot(moved, s.cloth.axis_v);
  }
  const double per_E = along.colPivHouseholderQr().solve(moved_u)[3],
               nu = across.colPivHouseholderQr().solve(moved_v)[2];
  if (!(per_E > 0)) return {kMissing, kMissing};
  return {1 / per_E, nu / per_E};
}

}  // namespace clothbench::pbd_gpu
