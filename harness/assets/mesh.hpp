#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace clothbench::assets {

using Vector = Eigen::Vector3d;
using Box = Eigen::AlignedBox3d;
/// A rigid transformation: rotation and translation [m].
using Frame = Eigen::Isometry3d;

/// positions [m], xyz interleaved; triangles, 3 vertex indices each, counter-clockwise as seen from free space.
struct TriangleMesh {
  std::vector<double> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  std::size_t vertex_count() const { return positions.size() / 3; }
  Vector vertex(std::size_t i) const { return Vector::Map(positions.data() + 3 * i); }
  void add_vertex(const Vector& p) { positions.insert(positions.end(), {p.x(), p.y(), p.z()}); }
};

/// Whether the mesh is a closed manifold: no border, every edge used once in each direction, one fan of triangles
/// around every vertex.
bool is_closed_manifold(const TriangleMesh&);

/// Volume [m^3] by the divergence theorem: positive if a closed mesh's normals point outwards, negative for a room,
/// whose normals point inwards.
double signed_volume(const TriangleMesh&);

/// Closed regular prism with `sides` sides around `axis` (unit vector) and corners at distance `radius` from it.
/// Normals point outwards; the ends are triangle fans.
TriangleMesh prism(const Vector& axis, const Vector& center, double radius, double length, std::uint32_t sides);

}  // namespace clothbench::assets
