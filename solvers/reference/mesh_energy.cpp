#include "mesh_energy.hpp"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace clothbench::reference {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;
using Corners = std::array<std::uint32_t, 3>;

/// A triangle at rest, unfolded into a plane.
struct Flat {
  std::array<Eigen::Vector2d, 3> along, outward;  ///< unit vectors of edge k, from corner k to corner k + 1
  std::array<double, 3> length_m;
  double area_m2;
};

std::array<Eigen::Vector3d, 3> points_of(const std::array<Vec3, 3>& x) {
  return {Eigen::Vector3d::Map(x[0].data()), Eigen::Vector3d::Map(x[1].data()), Eigen::Vector3d::Map(x[2].data())};
}

Flat flatten(const ClothMesh& mesh, std::size_t triangle) {
  const std::array<Eigen::Vector3d, 3> p = points_of(rest_corners(mesh, triangle));
  const Eigen::Vector3d u = (p[1] - p[0]).normalized();
  const Eigen::Vector3d v = (p[1] - p[0]).cross(p[2] - p[0]).normalized().cross(u);
  Flat f;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d edge = p[(k + 1) % 3] - p[k];
    f.length_m[k] = edge.norm();
    f.along[k] = Eigen::Vector2d(u.dot(edge), v.dot(edge)) / f.length_m[k];
    f.outward[k] = {f.along[k].y(), -f.along[k].x()};
  }
  f.area_m2 = (p[1] - p[0]).cross(p[2] - p[0]).norm() / 2;
  return f;
}

/// Contribution to a triangle's second derivatives (xx, yy, sqrt(2) xy) by a unit derivative in direction `of` at the
/// middle of edge k: the triangle's mean second derivative is an integral of first derivatives over its border.
Eigen::Vector3d curvature(const Flat& f, int k, const Eigen::Vector2d& of) {
  const Eigen::Vector2d n = f.length_m[k] / f.area_m2 * f.outward[k];
  return {n.x() * of.x(), n.y() * of.y(), (n.x() * of.y() + n.y() * of.x()) / std::sqrt(2.0)};
}

/// Unknowns: positions of vertices, then one derivative across each edge: outward from the triangle whose corners pass
/// the edge from its lower vertex index to the higher.
class Unknowns {
 public:
  Unknowns(const ClothMesh& mesh, const std::vector<std::uint32_t>& pinned) : vertices_(mesh.vertices.size()) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Corners& c = mesh.triangles[t];
      const bool held =
          std::all_of(c.begin(), c.end(), [&](auto v) { return std::binary_search(pinned.begin(), pinned.end(), v); });
      for (int k = 0; k < 3; ++k) {
        const auto edge = key(c, k);
        edges_.try_emplace(edge, vertices_ + edges_.size());
        if (held) clamp_of_.try_emplace(edge, t);
      }
    }
  }

  std::size_t vertices() const { return vertices_; }
  std::size_t count() const { return vertices_ + edges_.size(); }

  /// Adds `factor` times the derivative along edge k's outward normal to `row`, which has one entry per unknown.
  void add_across(const ClothMesh& mesh, std::size_t triangle, int k, const Eigen::Vector3d& factor,
                  std::map<std::size_t, Eigen::Vector3d>& row) const {
    const Corners& c = mesh.triangles[triangle];
    const auto clamp = clamp_of_.find(key(c, k));
    if (clamp == clamp_of_.end()) {
      at(row, edges_.at(key(c, k))) += (c[k] < c[(k + 1) % 3] ? 1 : -1) * factor;
      return;
    }
    // Gradient of the linear position in the clamped triangle: a corner contributes along its opposite edge's normal.
    const Flat f = flatten(mesh, clamp->second);
    const Corners& held = mesh.triangles[clamp->second];
    int edge = 0;
    while (key(held, edge) != key(c, k)) ++edge;
    const double sign = held[edge] == c[k] ? 1 : -1;
    for (int i = 0; i < 3; ++i) {
      const int opposite = (i + 1) % 3;
      const double slope = -f.length_m[opposite] / (2 * f.area_m2) * f.outward[opposite].dot(f.outward[edge]);
      at(row, held[i]) += sign * slope * factor;
    }
  }

  static Eigen::Vector3d& at(std::map<std::size_t, Eigen::Vector3d>& row, std::size_t unknown) {
    return row.try_emplace(unknown, Eigen::Vector3d::Zero()).first->second;
  }

 private:
  static std::pair<std::uint32_t, std::uint32_t> key(const Corners& c, int k) {
    return std::minmax(c[k], c[(k + 1) % 3]);
  }

  std::size_t vertices_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> edges_, clamp_of_;
};

}  // namespace

Sparse bending_matrix(const ClothMesh& mesh, double rigidity_N_m, const std::vector<std::uint32_t>& pinned) {
  const Unknowns unknowns(mesh, pinned);
  Triplets all;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Flat f = flatten(mesh, t);
    std::map<std::size_t, Eigen::Vector3d> row;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d along = curvature(f, k, f.along[k]) / f.length_m[k];
      Unknowns::at(row, mesh.triangles[t][(k + 1) % 3]) += along;
      Unknowns::at(row, mesh.triangles[t][k]) -= along;
      unknowns.add_across(mesh, t, k, curvature(f, k, f.outward[k]), row);
    }
    for (const auto& [i, a] : row)
      for (const auto& [j, b] : row)
        all.emplace_back(static_cast<int>(i), static_cast<int>(j), rigidity_N_m * f.area_m2 * a.dot(b));
  }
  const int n = static_cast<int>(unknowns.vertices()), m = static_cast<int>(unknowns.count()) - n;
  Sparse whole(n + m, n + m);
  whole.setFromTriplets(all.begin(), all.end());
  Sparse across = whole.block(n, n, m, m);
  // The derivative across a clamp's edge is no unknown; its empty row gets a diagonal of 1.
  for (int e = 0; e < m; ++e)
    if (!(across.coeff(e, e) > 0)) across.coeffRef(e, e) = 1;
  const Sparse vertex = whole.block(0, 0, n, n), mixed = whole.block(n, 0, m, n);
  const Eigen::SimplicialLLT<Sparse> solver(across);
  Triplets kept;
  const double least = 1e-13 * vertex.diagonal().maxCoeff();
  for (int column = 0; column < n; ++column) {
    const Eigen::VectorXd rest =
        vertex.col(column) - mixed.transpose() * solver.solve(Eigen::VectorXd(mixed.col(column)));
    for (int i = 0; i < n; ++i)
      if (std::abs(rest[i]) > least) kept.emplace_back(i, column, rest[i]);
  }
  Sparse out(n, n);
  out.setFromTriplets(kept.begin(), kept.end());
  return (out + Sparse(out.transpose())) / 2;
}

Eigen::Matrix3d triangle_compliance(const std::array<Vec3, 3>& corners, double stiffness_N_per_m) {
  constexpr double nu = kMeshPoissonRatio;
  const std::array<Eigen::Vector3d, 3> p = points_of(corners);
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
