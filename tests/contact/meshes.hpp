#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "metrics/contact/contact_probe.hpp"

namespace clothbench::contact {

/// A mesh that owns its arrays.
struct Mesh {
  std::vector<double> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  TriangleMeshView view() const { return {positions, triangles}; }
  std::uint32_t add(const Point<3>& p) {
    positions.insert(positions.end(), {p[0], p[1], p[2]});
    return static_cast<std::uint32_t>(positions.size() / 3 - 1);
  }
  template <class Map>
  Mesh mapped(Map map) const {
    Mesh result{{}, triangles};
    for (std::size_t i = 0; i < positions.size() / 3; ++i) result.add(map(view().vertex(i)));
    return result;
  }
  Mesh moved(const Point<3>& by) const {
    return mapped([&](const Point<3>& p) { return Point<3>(p + by); });
  }
};

/// n x m cells, corner at `origin`, normal u x v.
inline Mesh sheet(int n, int m, const Point<3>& origin, const Point<3>& u, const Point<3>& v) {
  Mesh mesh;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) mesh.add(origin + u * (double(i) / n) + v * (double(j) / m));
  const auto at = [n](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

/// Square, side length 1, in y = 0, normal +y.
inline Mesh patch(int n) { return sheet(n, n, {-0.5, 0, -0.5}, {0, 0, 1}, {1, 0, 0}); }

/// Octahedron, every triangle cut into n^2, on the sphere. Closed, normals outwards, 8 n^2 triangles.
inline Mesh octasphere(int n, double radius) {
  Mesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> known;
  const auto vertex = [&](int x, int y, int z) {
    const auto [entry, is_new] = known.try_emplace({x, y, z}, 0u);
    if (is_new) entry->second = mesh.add(Point<3>(x, y, z).normalized() * radius);
    return entry->second;
  };
  for (int octant = 0; octant < 8; ++octant) {
    const int sx = octant & 1 ? -1 : 1, sy = octant & 2 ? -1 : 1, sz = octant & 4 ? -1 : 1;
    const bool turned = sx * sy * sz < 0;
    const auto at = [&](int i, int j) { return vertex(sx * i, sy * j, sz * (n - i - j)); };
    const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      turned ? mesh.triangles.push_back({a, c, b}) : mesh.triangles.push_back({a, b, c});
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        triangle(at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j < n - 1) triangle(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
  }
  return mesh;
}

/// A closed sphere with bumps in all directions.
inline Mesh bumpy_ball(int n, double radius) {
  return octasphere(n, 1).mapped([&](const Point<3>& p) {
    const double bump = std::sin(9 * p[0] + 1) * std::sin(11 * p[1] + 2) * std::sin(13 * p[2] + 3);
    return Point<3>(p * radius * (1 + 0.1 * bump));
  });
}

/// A rotation without symmetry.
inline Eigen::Matrix3d some_rotation() {
  return (Eigen::AngleAxisd(0.7, Point<3>(1, 2, 3).normalized()) *
          Eigen::AngleAxisd(1.9, Point<3>(-3, 1, 0.5).normalized()))
      .toRotationMatrix();
}

/// Every triangle with its own three vertices.
inline Mesh unshared(const Mesh& mesh) {
  Mesh result;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Simplex<3> v = mesh.view().triangle(t);
    result.triangles.push_back({result.add(v[0]), result.add(v[1]), result.add(v[2])});
  }
  return result;
}

/// Contact of a cloth with a mesh.
inline ContactSample against(const Mesh& cloth, const Mesh& object, bool has_inside = true) {
  return mesh_contact(cloth.view(), edges_of(cloth.triangles), TriangleTree(object.view()), has_inside);
}

/// Both meshes in one.
inline Mesh together(const Mesh& a, const Mesh& b) {
  Mesh all = a;
  const auto first = static_cast<std::uint32_t>(a.positions.size() / 3);
  all.positions.insert(all.positions.end(), b.positions.begin(), b.positions.end());
  for (auto t : b.triangles) {
    for (std::uint32_t& v : t) v += first;
    all.triangles.push_back(t);
  }
  return all;
}

}  // namespace clothbench::contact
