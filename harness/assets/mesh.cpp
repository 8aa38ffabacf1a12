#include "assets/mesh.hpp"

#include <cmath>
#include <numbers>
#include <unordered_map>

namespace clothbench::assets {

bool is_closed_manifold(const TriangleMesh& mesh) {
  // Corner 3 t + k is where the k-th edge of triangle t starts.
  const auto vertex = [&](std::size_t corner) { return mesh.triangles[corner / 3][corner % 3]; };
  const auto next = [](std::size_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; };
  const auto edge = [](std::uint32_t from, std::uint32_t to) { return std::uint64_t{from} << 32 | to; };
  const std::size_t corners = 3 * mesh.triangles.size();
  std::unordered_map<std::uint64_t, std::size_t> starts;
  for (std::size_t c = 0; c < corners; ++c) {
    const std::uint32_t from = vertex(c), to = vertex(next(c));
    if (from == to || !starts.emplace(edge(from, to), c).second) return false;
  }
  std::vector<bool> seen(corners, false), has_fan(mesh.vertex_count(), false);
  for (std::size_t c = 0; c < corners; ++c) {
    if (seen[c]) continue;
    if (has_fan[vertex(c)]) return false;
    has_fan[vertex(c)] = true;
    for (std::size_t at = c; !seen[at];) {
      seen[at] = true;
      const auto opposite = starts.find(edge(vertex(next(at)), vertex(at)));
      if (opposite == starts.end()) return false;
      at = next(opposite->second);
    }
  }
  return true;
}

double signed_volume(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return 0;
  // From one of its own points: a mesh far from the origin would lose digits.
  const Vector origin = mesh.vertex(mesh.triangles[0][0]);
  double six = 0;
  for (const auto& t : mesh.triangles)
    six += (mesh.vertex(t[0]) - origin).dot((mesh.vertex(t[1]) - origin).cross(mesh.vertex(t[2]) - origin));
  return six / 6;
}

TriangleMesh prism(const Vector& axis, const Vector& center, double radius, double length, std::uint32_t sides) {
  const Vector a = axis.unitOrthogonal(), b = axis.cross(a), half = 0.5 * length * axis;
  TriangleMesh mesh;
  for (std::uint32_t k = 0; k < sides; ++k) {
    const double angle = 2 * std::numbers::pi * k / sides;
    const Vector rim = center + radius * (std::cos(angle) * a + std::sin(angle) * b);
    mesh.add_vertex(rim - half);
    mesh.add_vertex(rim + half);
  }
  mesh.add_vertex(center - half);
  mesh.add_vertex(center + half);
  for (std::uint32_t k = 0; k < sides; ++k) {
    const std::uint32_t p = 2 * k, q = 2 * ((k + 1) % sides), low = 2 * sides, high = low + 1;
    mesh.triangles.push_back({p, q, q + 1});
    mesh.triangles.push_back({p, q + 1, p + 1});
    mesh.triangles.push_back({low, q, p});
    mesh.triangles.push_back({high, p + 1, q + 1});
  }
  return mesh;
}

}  // namespace clothbench::assets
