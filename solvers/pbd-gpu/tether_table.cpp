#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "chain_plan.hpp"
#include "line_plan.hpp"
#include "substeps.hpp"

namespace clothbench::pbd_gpu {
namespace {

constexpr std::size_t kMost = 4;  // groups of pinned vertices
constexpr double kFlat = 1e-6;    // of the longest side

struct Adjacency {
  std::vector<std::vector<std::pair<std::uint32_t, double>>>
      beside;  ///< of each vertex: neighbours and their distance at rest
};

Adjacency adjacency_of(const Scene& s) {
  Adjacency w;
  w.beside.resize(s.cloth.vertex_count());
  for (const Edge& e : edges(s.cloth, EdgeKind::Structural)) {
    w.beside[e.a].emplace_back(e.b, e.rest_m);
    w.beside[e.b].emplace_back(e.a, e.rest_m);
  }
  return w;
}

/// Connected groups of pinned vertices, largest first.
std::vector<std::vector<std::uint32_t>> groups_of(const Scene& s, const Adjacency& edges) {
  std::vector<std::uint8_t> left(s.cloth.vertex_count(), 0);
  for (const std::uint32_t v : s.pins.vertices) left[v] = 1;
  std::vector<std::vector<std::uint32_t>> out;
  for (const std::uint32_t seed : s.pins.vertices) {
    if (left[seed] == 0) continue;
    left[seed] = 0;
    std::vector<std::uint32_t> group = {seed};
    for (std::size_t k = 0; k < group.size(); ++k)
      for (const auto& [to, length] : edges.beside[group[k]])
        if (std::exchange(left[to], 0) != 0) group.push_back(to);
    out.push_back(std::move(group));
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return out;
}

double cross2(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// True if the mesh rests flat as it starts (all z alike) with a convex border: the shortest path through the cloth is
/// then straight.
bool is_convex_sheet(const ClothMesh& m) {
  if (!m.pattern_m.empty()) return false;
  double low = m.vertices[0][2], high = low, size = 0, area = 0;
  for (const Vec3& x : m.vertices) {
    low = std::min(low, x[2]);
    high = std::max(high, x[2]);
    size = std::max({size, std::abs(x[0] - m.vertices[0][0]), std::abs(x[1] - m.vertices[0][1])});
  }
  if (!(high - low <= kFlat * size)) return false;
  for (const auto& t : m.triangles) area += std::abs(cross2(m.vertices[t[0]], m.vertices[t[1]], m.vertices[t[2]])) / 2;
  // A flat mesh has the area of its convex hull (Andrew's monotone chain) only if its border is convex.
  std::vector<Vec3> points = m.vertices, hull;
  std::sort(points.begin(), points.end());
  for (const int side : {0, 1}) {
    const std::size_t start = hull.size();
    for (const Vec3& p : points) {
      while (hull.size() >= start + 2 && cross2(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    if (side == 0) std::reverse(points.begin(), points.end());
  }
  double hull_area = 0;
  for (std::size_t k = 2; k < hull.size(); ++k) hull_area += cross2(hull[0], hull[k - 1], hull[k]) / 2;
  return area >= (1 - 1e-3) * hull_area;
}

/// For every vertex, the nearest vertex of a group and its distance through the cloth at rest.
class Reach {
 public:
  Reach(const Scene& s, const Adjacency& edges)
      : scene_(s), edges_(edges), straight_(!s.cloth.mesh || is_convex_sheet(*s.cloth.mesh)) {}

  std::vector<TetherEnd> to(const std::vector<std::uint32_t>& group) const {
    std::vector<TetherEnd> out(scene_.cloth.vertex_count(), {0, std::numeric_limits<float>::max()});
    if (!straight_) return along_edges(group);
    for (std::uint32_t v = 0; v < out.size(); ++v)
      for (const std::uint32_t p : group)
        if (const auto d = static_cast<float>(straight(v, p)); d < out[v].reach) out[v] = {p, d};
    return out;
  }

 private:
  double straight(std::uint32_t a, std::uint32_t b) const {
    const Cloth& c = scene_.cloth;
    if (c.mesh) {
      const Vec3 &p = c.mesh->vertices[a], &q = c.mesh->vertices[b];
      return norm({p[0] - q[0], p[1] - q[1], p[2] - q[2]});
    }
    const auto columns = static_cast<std::uint32_t>(c.columns);
    const double u = std::abs(c.line_u_m(static_cast<int>(a % columns)) - c.line_u_m(static_cast<int>(b % columns))),
                 v = std::abs(static_cast<double>(a / columns) - static_cast<double>(b / columns)) * c.dv();
    return scene_.needs.has(Feature::Shear) ? std::hypot(u, v) : u + v;
  }

  /// Shortest paths along edges from all vertices of the group at once (Dijkstra 1959).
  std::vector<TetherEnd> along_edges(const std::vector<std::uint32_t>& group) const {
    std::vector<TetherEnd> out(scene_.cloth.vertex_count(), {0, -1});
    std::vector<double> best(out.size(), std::numeric_limits<double>::infinity());
    using Item = std::pair<double, std::uint32_t>;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> next;
    for (const std::uint32_t p : group) {
      best[p] = 0;
      out[p] = {p, 0};
      next.emplace(0, p);
    }
    while (!next.empty()) {
      const auto [d, v] = next.top();
      next.pop();
      if (d > best[v]) continue;
      for (const auto& [to, length] : edges_.beside[v])
        if (d + length < best[to]) {
          best[to] = d + length;
          out[to] = {out[v].to, static_cast<float>(d + length)};
          next.emplace(d + length, to);
        }
    }
    return out;
  }

  const Scene& scene_;
  const Adjacency& edges_;
  const bool straight_;
};

}  // namespace

TetherTable tether_table(const Scene& scene) {
  TetherTable t;
  if (!scene.grips.vertices.empty())
    t.why_not = "hands move what holds the cloth";
  else if (scene.pins.vertices.empty())
    t.why_not = "nothing is pinned";
  else if (!scene.material.regions.empty())
    t.why_not = "its stiffness is not the same everywhere";
  else if (!scene.cloth.mass_factors.empty() && scene.material.membrane_stiffness_N_per_m)
    t.why_not = "masses are scaled";
  if (!t.why_not.empty()) return t;
  const Adjacency edges = adjacency_of(scene);
  std::vector<std::vector<std::uint32_t>> groups = groups_of(scene, edges);
  if (groups.size() > kMost) groups.resize(kMost);
  const Reach reach(scene, edges);
  const std::size_t n = scene.cloth.vertex_count();
  const double stretch = tether_stretch(scene);
  const std::vector<double> x = initial_positions(scene);
  t.a_vertex = static_cast<std::uint32_t>(groups.size());
  t.ends.resize(n * groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::vector<TetherEnd> ends = reach.to(groups[g]);
    for (std::size_t v = 0; v < n; ++v) {
      TetherEnd e = ends[v];
      const Vec3 offset = {x[3 * v] - x[3 * e.to], x[3 * v + 1] - x[3 * e.to + 1], x[3 * v + 2] - x[3 * e.to + 2]};
      if (e.reach >= 0 && !(norm(offset) <= stretch * static_cast<double>(e.reach) + 1e-6 * scene.cloth.width_m))
        return {0, {}, "the cloth starts stretched"};
      e.reach *= static_cast<float>(stretch);
      t.ends[groups.size() * v + g] = e;
    }
  }
  return t;
}

}  // namespace clothbench::pbd_gpu
