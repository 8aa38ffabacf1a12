#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace clothbench::assets {

using Vector = Eigen::Vector3d;
using Box = Eigen::AlignedBox3d;
/// A rigid placement: rotation and translation [m].
using Frame = Eigen::Isometry3d;

/// positions [m], xyz interleaved; triangles, 3 vertex indices each, seen counter-clockwise from free space.
struct TriangleMesh {
  std::vector<double> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  std::size_t vertex_count() const { return positions.size() / 3; }
  Vector vertex(std::size_t i) const { return Vector::Map(positions.data() + 3 * i); }
  void add_vertex(const Vector& p) { positions.insert(positions.end(), {p.x(), p.y(), p.z()}); }
};

/// Topology of a mesh. `closed_manifold()`: no border, every edge used once in each direction, one fan of triangles
/// around every vertex.
struct Topology {
  std::size_t edges = 0;           ///< undirected
  std::size_t border_edges = 0;    ///< with one triangle
  std::size_t bad_edges = 0;       ///< with more than two triangles, or used twice in one direction
  std::size_t split_vertices = 0;  ///< fans of triangles beyond the first, summed over vertices
  std::size_t unused_vertices = 0;
  std::size_t components = 0;
  long euler = 0;  ///< used vertices - edges + triangles
  bool closed_manifold() const { return border_edges == 0 && bad_edges == 0 && split_vertices == 0; }
};
Topology topology(const TriangleMesh&);

/// Volume [m^3] by the divergence theorem: positive if the normals of a closed mesh point outwards, negative for a
/// room, whose normals point inwards.
double signed_volume(const TriangleMesh&);
double area(const TriangleMesh&, std::size_t triangle);
Box bounding_box(const TriangleMesh&);

/// Closed regular prism with `sides` sides around `axis` (unit vector) and corners at `radius` from it. Normals point
/// outwards; the ends are triangle fans.
TriangleMesh prism(const Vector& axis, const Vector& center, double radius, double length, std::uint32_t sides);

}  // namespace clothbench::assets
