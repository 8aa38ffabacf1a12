#include "assets/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace clothbench::assets {
namespace {

class Groups {
 public:
  explicit Groups(std::size_t n) : count_(n) {
    parent_.reserve(n);
    for (std::size_t i = 0; i < n; ++i) parent_.push_back(i);
  }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    parent_[a] = b;
    --count_;
  }
  std::size_t count() const { return count_; }

 private:
  std::vector<std::size_t> parent_;
  std::size_t count_;
};

/// One triangle's passage along an edge; corner = 3 * triangle + k starts it.
struct Passage {
  std::uint32_t low, high;
  bool upwards;
  std::size_t corner;
};

std::vector<Passage> passages(const TriangleMesh& mesh) {
  std::vector<Passage> all;
  all.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      all.push_back({std::min(a, b), std::max(a, b), a < b, 3 * t + k});
    }
  std::sort(all.begin(), all.end(), [](const Passage& x, const Passage& y) {
    return std::tie(x.low, x.high, x.corner) < std::tie(y.low, y.high, y.corner);
  });
  return all;
}

}  // namespace

Topology topology(const TriangleMesh& mesh) {
  Topology found;
  if (mesh.triangles.empty() || mesh.positions.empty()) return found;
  const std::vector<Passage> all = passages(mesh);
  Groups vertices(mesh.vertex_count()), corners(3 * mesh.triangles.size());
  const auto next = [](std::size_t corner) { return corner - corner % 3 + (corner % 3 + 1) % 3; };
  for (std::size_t i = 0; i < all.size();) {
    std::size_t end = i;
    while (end < all.size() && all[end].low == all[i].low && all[end].high == all[i].high) ++end;
    ++found.edges;
    vertices.join(all[i].low, all[i].high);
    if (end - i == 1) ++found.border_edges;
    if (end - i > 2 || (end - i == 2 && all[i].upwards == all[i + 1].upwards)) ++found.bad_edges;
    if (end - i == 2 && all[i].upwards != all[i + 1].upwards) {
      corners.join(all[i].corner, next(all[i + 1].corner));
      corners.join(next(all[i].corner), all[i + 1].corner);
    }
    i = end;
  }
  std::vector<bool> used(mesh.vertex_count(), false);
  for (const auto& t : mesh.triangles)
    for (std::uint32_t v : t) used[v] = true;
  const auto used_count = static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
  found.unused_vertices = mesh.vertex_count() - used_count;
  found.split_vertices = corners.count() - used_count;
  found.components = vertices.count() - found.unused_vertices;
  found.euler =
      static_cast<long>(used_count) - static_cast<long>(found.edges) + static_cast<long>(mesh.triangles.size());
  return found;
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

double area(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return 0.5 * (mesh.vertex(t[1]) - mesh.vertex(t[0])).cross(mesh.vertex(t[2]) - mesh.vertex(t[0])).norm();
}

Box bounding_box(const TriangleMesh& mesh) {
  Box box;
  for (std::size_t i = 0; i < mesh.vertex_count(); ++i) box.extend(mesh.vertex(i));
  return box;
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
