#include "xpbd/constraints.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <queue>
#include <utility>

#include "clothbench/vector.hpp"
#include "xpbd/mesh/edge_paths.hpp"

namespace clothbench::pbd_gpu {
namespace {

constexpr double kFlat = 1e-6;               // height of a flat mesh, relative to its longest side
constexpr double kShort = 0.5, kLong = 1.5;  // limits of a start that is not crumpled, relative to a link's rest length
constexpr double kAside = 1e-3;              // share of a cell; far above float32's rounding, far below what is visible

/// Why a scene has no tethers, wherever its vertices start; empty: it may have some.
std::string why_no_tethers(const Scene& scene, bool wanted) {
  if (!wanted) return "setting tethers=false";
  if (!scene.grips.vertices.empty()) return "hands move the attached vertices";
  // Slack is computed from the weight of an even sheet.
  if (!scene.cloth.mass_factors.empty() && scene.material.membrane_stiffness_N_per_m) return "masses are scaled";
  return scene.pins.vertices.empty() ? "nothing is pinned" : "";
}

/// Factor of tether lengths: 1 + slack (tethers_of).
double tether_stretch(const Scene& scene) {
  const Cloth& c = scene.cloth;
  const auto Y = scene.material.membrane_stiffness_N_per_m;
  if (!Y) return 1;
  const double rho = c.areal_density_kg_per_m2, length = std::hypot(c.width_m, c.height_m);
  const double slack =
      5 * rho * norm(scene.gravity_m_per_s2) * length / *Y + 2 * norm(c.initial_velocity_m_per_s) * std::sqrt(rho / *Y);
  return 1 + slack;
}

/// Distance [m] through a grid at rest between vertices that are u and v [m] apart along the grid's axes.
double way_through(const Scene& s, double u, double v) {
  return s.needs.has(Feature::Shear) ? std::hypot(u, v) : u + v;
}

/// Extra length [m] of a tether, for a vertex at distance r through the cloth from pins that span `width`: five times
/// the elongation of a sheet around a small group of pins that carries its whole weight (force M g spread over r).
double spread_slack_m(const Scene& s, double width, double r) {
  const double scale = tether_spread_m(s);
  return scale > 0 ? scale * std::log1p(r / width) : 0;
}

constexpr const char* kStartsStretched = "the cloth starts stretched";
/// True if vertices a and b start within a tether's length. Otherwise the cloth starts stretched.
bool starts_within(const Scene& s, const std::vector<double>& start, std::size_t a, std::size_t b, double length) {
  return norm(minus(vertex_at(start, a), vertex_at(start, b))) <= length + 1e-6 * s.cloth.width_m;
}

/// Connected groups of pinned vertices. `beside(v, visit)` calls visit for every neighbour of v.
template <class Beside>
std::vector<std::vector<std::uint32_t>> connected_pins(const Scene& s, const Beside& beside) {
  std::vector<std::uint8_t> left(s.cloth.vertex_count(), 0);
  for (const std::uint32_t v : s.pins.vertices) left[v] = 1;
  std::vector<std::vector<std::uint32_t>> out;
  for (const std::uint32_t seed : s.pins.vertices) {
    if (std::exchange(left[seed], 0) == 0) continue;
    std::vector<std::uint32_t> group = {seed};
    for (std::size_t k = 0; k < group.size(); ++k)
      beside(group[k], [&](std::uint32_t to) {
        if (std::exchange(left[to], 0) != 0) group.push_back(to);
      });
    out.push_back(std::move(group));
  }
  return out;
}

/// Each connected group of pinned vertices as the rectangle that it fills, or its first vertex if it fills none.
std::vector<PinnedRectangle> rectangles(const Scene& s) {
  const auto columns = static_cast<std::uint32_t>(s.cloth.columns), rows = static_cast<std::uint32_t>(s.cloth.rows);
  const auto beside = [&](std::uint32_t v, const auto& visit) {
    const std::uint32_t i = v % columns, j = v / columns;
    for (const auto& [a, b] : {std::pair{i + 1, j}, {i - 1, j}, {i, j + 1}, {i, j - 1}})
      if (a < columns && b < rows) visit(b * columns + a);
  };
  std::vector<PinnedRectangle> found;
  for (const std::vector<std::uint32_t>& group : connected_pins(s, beside)) {
    const std::uint32_t first_column = group[0] % columns, first_row = group[0] / columns;
    const PinnedRectangle corner{first_column, first_row, first_column, first_row};
    PinnedRectangle r = corner;
    for (const std::uint32_t v : group) {
      const std::uint32_t i = v % columns, j = v / columns;
      r = {std::min(r.first_column, i), std::min(r.first_row, j), std::max(r.last_column, i), std::max(r.last_row, j)};
    }
    const std::size_t area = std::size_t{r.last_column - r.first_column + 1} * (r.last_row - r.first_row + 1);
    found.push_back(group.size() == area ? r : corner);
  }
  return found;
}

bool start_within(const Scene& s, const Tethers& t) {
  const Cloth& c = s.cloth;
  const std::vector<double> x = initial_positions(s);
  const auto at = [&](int i, int j) { return static_cast<std::size_t>(j * c.columns + i); };
  for (int j = 0; j < c.rows; ++j)
    for (int i = 0; i < c.columns; ++i)
      for (const PinnedRectangle& r : t.to) {
        const int a = std::clamp(i, static_cast<int>(r.first_column), static_cast<int>(r.last_column)),
                  b = std::clamp(j, static_cast<int>(r.first_row), static_cast<int>(r.last_row));
        const double reach = way_through(s, std::abs(i - a) * c.du(), std::abs(j - b) * c.dv());
        if (!starts_within(s, x, at(i, j), at(a, b), t.stretch * reach)) return false;
      }
  return true;
}

/// Neighbours of each vertex, and their distance at rest.
using Adjacency = std::vector<std::vector<std::pair<std::uint32_t, double>>>;

Adjacency adjacency_of(const Scene& s) {
  Adjacency beside(s.cloth.vertex_count());
  for (const Edge& e : edges(s.cloth, EdgeKind::Structural)) {
    beside[e.a].emplace_back(e.b, e.rest_m);
    beside[e.b].emplace_back(e.a, e.rest_m);
  }
  return beside;
}

double cross2(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// True if the mesh starts at rest, flat (all z equal) and with a convex border: shortest paths are then straight.
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

/// Finds, for every vertex, the nearest vertex of a group and its distance through the cloth at rest [m].
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

  /// Straight distance at rest [m].
  double straight(std::uint32_t a, std::uint32_t b) const {
    const Cloth& c = scene_.cloth;
    if (c.mesh) return norm(minus(c.mesh->vertices[a], c.mesh->vertices[b]));
    const auto columns = static_cast<std::uint32_t>(c.columns);
    const double u = std::abs(c.line_u_m(static_cast<int>(a % columns)) - c.line_u_m(static_cast<int>(b % columns))),
                 v = std::abs(static_cast<double>(a / columns) - static_cast<double>(b / columns)) * c.dv();
    return way_through(scene_, u, v);
  }

 private:
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
      for (const auto& [to, length] : edges_[v])
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

/// Pseudo-random number in [-1, 1) from a counter (SplitMix64; Steele, Lea & Flood 2014).
double scattered(std::uint64_t n) {
  std::uint64_t z = (n + 1) * 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1;
}

}  // namespace

double eigenvalue_bound(const std::vector<double>& mass,
                        const std::function<void(const std::vector<double>&, std::vector<double>&)>& times) {
  constexpr int kSteps = 20;
  std::vector<double> v(mass.size(), 1), next(mass.size());
  double largest = 0;
  for (int step = 0; step < kSteps; ++step) {
    times(v, next);
    largest = 0;
    double greatest = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
      next[i] /= mass[i];
      largest = std::max(largest, next[i] / v[i]);
      greatest = std::max(greatest, next[i]);
    }
    if (!(greatest > 0)) return 0;
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = std::max(next[i] / greatest, 1e-3);
  }
  return largest;
}

double tether_spread_m(const Scene& scene) {
  const auto Y = scene.material.membrane_stiffness_N_per_m;
  if (!Y) return 0;
  const std::vector<double> masses = vertex_masses(scene);
  return 5 * std::accumulate(masses.begin(), masses.end(), 0.0) * norm(scene.gravity_m_per_s2) / *Y;
}

Tethers tethers_of(const Scene& scene, bool wanted) {
  Tethers t;
  t.reason = why_no_tethers(scene, wanted);
  if (!t.reason.empty()) return t;
  t.to = rectangles(scene);
  if (t.to.size() > Tethers::kMax) t.to.resize(Tethers::kMax);
  t.stretch = tether_stretch(scene);
  if (start_within(scene, t)) return t;
  t.to.clear();
  t.reason = kStartsStretched;
  return t;
}

TetherTable tether_table(const Scene& scene, bool wanted) {
  TetherTable t;
  t.reason = why_no_tethers(scene, wanted);
  if (t.reason.empty() && !scene.material.regions.empty()) t.reason = "the cloth's stiffness is not uniform";
  if (!t.reason.empty()) return t;
  const Adjacency edges = adjacency_of(scene);
  std::vector<std::vector<std::uint32_t>> groups = connected_pins(scene, [&](std::uint32_t v, const auto& visit) {
    for (const auto& [to, length] : edges[v]) visit(to);
  });
  std::stable_sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  if (groups.size() > Tethers::kMax) groups.resize(Tethers::kMax);
  const Reach reach(scene, edges);
  const std::size_t n = scene.cloth.vertex_count();
  const double stretch = tether_stretch(scene);
  const std::vector<double> x = initial_positions(scene);
  t.a_vertex = static_cast<std::uint32_t>(groups.size());
  t.ends.resize(n * groups.size());
  std::vector<double> widths;
  for (const auto& group : groups) {
    double width = scene.cloth.mesh ? scene.cloth.mesh->edge_m : std::max(scene.cloth.du(), scene.cloth.dv());
    for (const std::uint32_t a : group) width = std::max(width, reach.straight(group.front(), a));
    widths.push_back(width);
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::vector<TetherEnd> ends = reach.to(groups[g]);
    for (std::size_t v = 0; v < n; ++v) {
      TetherEnd e = ends[v];
      if (e.reach >= 0 && !starts_within(scene, x, v, e.to, stretch * static_cast<double>(e.reach)))
        return {0, {}, kStartsStretched};
      if (e.reach >= 0)
        e.reach += static_cast<float>((stretch - 1) * e.reach + spread_slack_m(scene, widths[g], e.reach));
      t.ends[groups.size() * v + g] = e;
    }
  }
  return t;
}

bool is_tethered(const Scene& scene, const nlohmann::json& settings) {
  return settings.value("tethers", true) &&
         (needs_chain_solver(scene) ? tether_table(scene).a_vertex > 0 : !tethers_of(scene).to.empty());
}

bool starts_crumpled(const Scene& scene) {
  if (scene.cloth.start.at_rest()) return false;
  const std::vector<double> x = initial_positions(scene);
  const std::vector<Edge> links = edges(scene.cloth, EdgeKind::Structural);
  return std::any_of(links.begin(), links.end(), [&](const Edge& e) {
    const double l = norm(minus(vertex_at(x, e.a), vertex_at(x, e.b)));
    return l < kShort * e.rest_m || l > kLong * e.rest_m;
  });
}

void break_symmetry(const Scene& scene, const std::vector<float>& inverse_mass, std::vector<double>& x) {
  const double aside = kAside * std::min(scene.cloth.du(), scene.cloth.dv());
  for (std::size_t k = 0; k < x.size(); ++k)
    if (inverse_mass[k / 3] > 0) x[k] += aside * scattered(k);
}

}  // namespace clothbench::pbd_gpu
