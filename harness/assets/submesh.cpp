#include "assets/submesh.hpp"

#include <algorithm>
#include <limits>

#include "clothbench/error.hpp"

namespace clothbench::assets {

bool overlaps(const Box& box, const Vector& a, const Vector& b, const Vector& c) {
  const Vector half = box.sizes() / 2, middle = box.center();
  const std::array<Vector, 3> p = {a - middle, b - middle, c - middle};
  const std::array<Vector, 3> edge = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  const auto separates = [&](const Vector& axis) {
    const double s0 = axis.dot(p[0]), s1 = axis.dot(p[1]), s2 = axis.dot(p[2]);
    const double reach = half.dot(axis.cwiseAbs());
    return std::min({s0, s1, s2}) > reach || std::max({s0, s1, s2}) < -reach;
  };
  for (int k = 0; k < 3; ++k)
    if (separates(Vector::Unit(k))) return false;
  if (separates(edge[0].cross(edge[1]))) return false;
  for (int k = 0; k < 3; ++k)
    for (const Vector& e : edge)
      if (separates(Vector::Unit(k).cross(e))) return false;
  return true;
}

SubMesh cut(const TriangleMesh& mesh, const Box& box, CutMode mode) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<bool> inside(mesh.vertex_count());
  for (std::size_t v = 0; v < inside.size(); ++v) inside[v] = box.contains(mesh.vertex(v));
  SubMesh out;
  std::vector<std::uint32_t> renumbered(mesh.vertex_count(), kUnused);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& tri = mesh.triangles[t];
    if (!(inside[tri[0]] || inside[tri[1]] || inside[tri[2]])) {
      if (mode != CutMode::Crossing) continue;
      if (!overlaps(box, mesh.vertex(tri[0]), mesh.vertex(tri[1]), mesh.vertex(tri[2]))) continue;
      ++out.crossing_only;
    }
    out.source_triangle.push_back(static_cast<std::uint32_t>(t));
    for (std::uint32_t v : tri) renumbered[v] = 0;
  }
  for (std::size_t v = 0; v < renumbered.size(); ++v) {
    if (renumbered[v] == kUnused) continue;
    renumbered[v] = static_cast<std::uint32_t>(out.source_vertex.size());
    out.source_vertex.push_back(static_cast<std::uint32_t>(v));
    out.mesh.add_vertex(mesh.vertex(v));
  }
  for (std::uint32_t t : out.source_triangle) {
    const auto& tri = mesh.triangles[t];
    out.mesh.triangles.push_back({renumbered[tri[0]], renumbered[tri[1]], renumbered[tri[2]]});
  }
  return out;
}

Box box_of(const std::array<Vector, 6>& points) {
  Box box;
  for (const Vector& p : points) {
    if (!p.allFinite()) throw Error("sub-mesh box: expected six finite points");
    box.extend(p);
  }
  return box;
}

Table table_in(const Box& world) {
  Table table;
  table.frame = Frame::Identity();
  // A table's own z is up.
  table.frame.linear() = (Eigen::Matrix3d() << 1, 0, 0, 0, 0, 1, 0, -1, 0).finished();
  const Vector low = world.min(), high = world.max();
  table.box = Box(Vector(low.x(), -high.z(), low.y()), Vector(high.x(), -low.z(), high.y()));
  return table;
}

std::array<Vector, 6> six_points(const Table& table, double below_m, double above_m) {
  const auto corners = table.top_corners();
  Vector middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
  const double top = table.top_height();
  std::array<Vector, 6> points = {corners[0], corners[1], corners[2], corners[3], middle, middle};
  points[4].y() = top - below_m;
  points[5].y() = top + above_m;
  return points;
}

}  // namespace clothbench::assets
