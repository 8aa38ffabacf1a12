// Initial positions and velocities of the vertices, for sheets at rest and all other starts.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "clothbench/scene.hpp"
#include "clothbench/vector.hpp"

namespace clothbench {
namespace {

/// SplitMix64 (Steele, Lea & Flood 2014), one stream per vertex, so that pins do not change other vertices' numbers.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream)
      : state_(seed * 0x9E3779B97F4A7C15u + (stream + 1) * 0xD1B54A32D192ED03u) {}

  /// Uniform in [0, 1), 53 bits.
  double uniform() {
    state_ += 0x9E3779B97F4A7C15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

  /// Standard normal, by the Box-Muller transform.
  double normal() {
    const double r = std::sqrt(-2 * std::log(1 - uniform()));
    return r * std::cos(2 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
};

/// Extent along u of the sheet, or of a mesh's bounding box: lowest coordinate and length [m].
struct AlongU {
  double low, width;
};

AlongU along_u(const Cloth& c) {
  if (!c.mesh) return {-c.width_m / 2, c.width_m};
  const auto [low, high] = std::ranges::minmax(c.mesh->vertices);  // compares by u first
  return {low[0], high[0] - low[0]};
}

/// Position [m] of a vertex in column i, in the frame (axis_u, axis_v, normal) about the centre.
Vec3 shaped(const Cloth& c, int i, Random& random) {
  const Start& s = c.start;
  const double turn = 2 * std::numbers::pi * random.uniform(), share = random.uniform();
  const double u = c.mesh ? c.mesh->vertices[static_cast<std::size_t>(i)][0] : c.line_u_m(i) - c.width_m / 2;
  switch (s.shape) {
    case Start::Shape::Sphere: {
      const double height = 2 * share - 1, ring = std::sqrt(1 - height * height);  // Archimedes: uniform in height
      return {s.radius_m * ring * std::cos(turn), s.radius_m * ring * std::sin(turn), s.radius_m * height};
    }
    case Start::Shape::Plane: {
      const double r = s.radius_m * std::sqrt(share);
      return {r * std::cos(turn), r * std::sin(turn), 0};
    }
    case Start::Shape::Line:
      return {u, 0, 0};
    case Start::Shape::Rest:
    case Start::Shape::Point:
    case Start::Shape::Folded:  // depends on j: see put_shape
      break;
  }
  return {};
}

/// Folded coordinate [m] along u, from the lowest: a triangle wave whose half period is one layer.
double folded_u(double u, double width_m, int folds) {
  const double leaf = width_m / folds, in_pair = std::fmod(u, 2 * leaf);
  return in_pair <= leaf ? in_pair : 2 * leaf - in_pair;
}

/// A vertex of a folded sheet, or of a mesh that is pressed flat and folded.
Vec3 folded(const Cloth& c, const AlongU& u, int i, int j) {
  if (!c.mesh)
    return {folded_u(c.line_u_m(i), c.width_m, c.start.folds) - c.width_m / 2, j * c.dv() - c.height_m / 2, 0};
  const Vec3& at = c.mesh->vertices[static_cast<std::size_t>(i)];
  return {u.low + folded_u(at[0] - u.low, u.width, c.start.folds), at[1], 0};
}

void put_shape(const Scene& scene, const std::vector<std::uint8_t>& pinned, std::vector<double>& x) {
  const Cloth& c = scene.cloth;
  const Vec3 normal = cross(c.axis_u, c.axis_v);
  const AlongU u = along_u(c);
  for (int j = 0; j < c.rows; ++j)
    for (int i = 0; i < c.columns; ++i) {
      const auto v = static_cast<std::size_t>(j * c.columns + i);
      Random random(c.start.seed, v);
      Vec3 p = shaped(c, i, random);
      if (c.start.shape == Start::Shape::Folded) p = folded(c, u, i, j);
      if (pinned[v] != 0) continue;
      for (std::size_t k = 0; k < 3; ++k)
        x[3 * v + k] = c.center_m[k] + p[0] * c.axis_u[k] + p[1] * c.axis_v[k] + p[2] * normal[k];
    }
}

std::size_t edge_number(const ClothMesh& mesh, const Edge& e) {
  const auto before = [](const Edge& p, const Edge& q) { return p.a != q.a ? p.a < q.a : p.b < q.b; };
  return static_cast<std::size_t>(std::lower_bound(mesh.edges.begin(), mesh.edges.end(), e, before) -
                                  mesh.edges.begin());
}

}  // namespace

std::vector<double> initial_positions(const Scene& scene) {
  const Cloth& c = scene.cloth;
  std::vector<double> x;
  x.reserve(3 * c.vertex_count());
  for (int j = 0; j < c.rows; ++j)
    for (int i = 0; i < c.columns; ++i)
      for (double value : scene.rest_position(i, j)) x.push_back(value);
  const Start& s = c.start;
  if (s.at_rest()) return x;
  std::vector<std::uint8_t> pinned(c.vertex_count(), 0);
  for (std::uint32_t v : scene.pins.vertices) pinned[v] = 1;
  if (s.shape != Start::Shape::Rest) put_shape(scene, pinned, x);
  for (const auto& group : s.merged)
    for (std::uint32_t v : group) std::copy_n(x.begin() + 3 * group.front(), 3, x.begin() + 3 * v);
  for (const Start::Move& m : s.moved)
    for (std::uint32_t v : m.vertices)
      for (std::size_t k = 0; k < 3; ++k) x[3 * v + k] += m.by_m[k];
  if (s.noise_m > 0)
    for (std::size_t v = 0; v < pinned.size(); ++v) {
      Random random(~s.seed, v);
      for (std::size_t k = 0; k < 3; ++k)
        if (const double by = s.noise_m * random.normal(); pinned[v] == 0) x[3 * v + k] += by;
    }
  return x;
}

std::vector<double> initial_velocities(const Scene& scene) {
  const Cloth& c = scene.cloth;
  const std::vector<double> x = initial_positions(scene);
  std::vector<double> v;
  v.reserve(x.size());
  for (std::size_t i = 0; i < c.vertex_count(); ++i) {
    const Vec3 turning = cross(c.spin_rad_per_s, minus(vertex_at(x, i), c.center_m));
    for (const double value : plus(c.initial_velocity_m_per_s, turning)) v.push_back(value);
  }
  return v;
}

std::vector<std::optional<double>> triangle_stiffnesses(const Scene& s) {
  std::vector<std::optional<double>> out(s.cloth.mesh->triangles.size(), s.material.membrane_stiffness_N_per_m);
  for (const StiffnessRegion& r : s.material.regions)
    for (const std::uint32_t t : r.triangles) out[t] = r.membrane_stiffness_N_per_m;
  return out;
}

std::vector<std::optional<double>> edge_stiffnesses(const Scene& s) {
  std::vector<std::optional<double>> out;
  if (!s.cloth.mesh || s.material.regions.empty()) {
    for (const Edge& e : edges(s.cloth, EdgeKind::Structural)) out.push_back(membrane_stiffness(s, e));
    return out;
  }
  const ClothMesh& mesh = *s.cloth.mesh;
  const std::vector<std::optional<double>> of_triangle = triangle_stiffnesses(s);
  std::vector<double> area(mesh.edges.size(), 0);
  out.assign(mesh.edges.size(), 0.0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::array<Vec3, 3> x = rest_corners(mesh, t);
    const double own = length(cross(minus(x[1], x[0]), minus(x[2], x[0])));
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
      const std::size_t e = edge_number(mesh, {a, b, 0, EdgeKind::Structural});
      if (!out[e] || !of_triangle[t])
        out[e] = std::nullopt;
      else
        *out[e] += own * *of_triangle[t];
      area[e] += own;
    }
  }
  for (std::size_t e = 0; e < out.size(); ++e)
    if (out[e]) *out[e] /= area[e];
  return out;
}

EdgeCell edge_cell(const Cloth& c, const Edge& e) {
  if (c.mesh) return {e.rest_m, c.mesh->areas_m2[edge_number(*c.mesh, e)] / e.rest_m};
  const int a = static_cast<int>(e.a) % c.columns, b = static_cast<int>(e.b) % c.columns;
  const bool down = e.a / static_cast<std::uint32_t>(c.columns) != e.b / static_cast<std::uint32_t>(c.columns);
  const auto width = [&](int column) {
    return c.column_factors.empty() ? c.du() : c.line_u_m(column + 1) - c.line_u_m(column);
  };
  if (a != b && down) return {width(std::min(a, b)), c.dv()};
  if (a != b) return {e.rest_m, c.dv()};
  return {e.rest_m, (width(std::max(a - 1, 0)) + width(std::min(a, c.columns - 2))) / 2};
}

bool on_border(const Cloth& c, const Edge& e) {
  if (c.mesh) return false;
  const auto columns = static_cast<std::uint32_t>(c.columns), rows = static_cast<std::uint32_t>(c.rows);
  const std::uint32_t ia = e.a % columns, ja = e.a / columns, ib = e.b % columns, jb = e.b / columns;
  if (ja == jb) return ja == 0 || ja == rows - 1;
  return ia == ib && (ia == 0 || ia == columns - 1);
}

double grid_spring_N_per_m(double Y, const EdgeCell& cell, bool shears) {
  const auto [a, b] = cell;
  return shears ? Y * std::max(9.0 / 8 * b / a - 3.0 / 8 * a / b, 0.1 * b / a) : Y * b / a;
}

double diagonal_spring_N_per_m(double Y, const EdgeCell& cell) {
  const auto [a, b] = cell;
  return 3.0 / 16 * Y * (a * a + b * b) / (a * b);
}

double spring_N_per_m(const Scene& s, const Edge& e, double Y) {
  const EdgeCell cell = edge_cell(s.cloth, e);
  if (e.kind == EdgeKind::Shear) return diagonal_spring_N_per_m(Y, cell);
  return (on_border(s.cloth, e) ? 0.5 : 1) * grid_spring_N_per_m(Y, cell, !s.cloth.mesh && s.needs.has(Feature::Shear));
}

std::optional<double> membrane_stiffness(const Scene& scene, const Edge& e) {
  const Material& m = scene.material;
  if (const auto& mesh = scene.cloth.mesh) {
    if (m.regions.empty()) return m.membrane_stiffness_N_per_m;
    return edge_stiffnesses(scene).at(edge_number(*mesh, e));
  }
  const auto of_cell = [&](int column) {
    std::optional<double> Y = m.membrane_stiffness_N_per_m;
    for (const StiffnessRegion& r : m.regions)
      if (column >= r.first && column <= r.last) Y = r.membrane_stiffness_N_per_m;
    return Y;
  };
  const int columns = scene.cloth.columns, a = static_cast<int>(e.a) % columns, b = static_cast<int>(e.b) % columns;
  if (a != b) return of_cell(std::min(a, b));
  const auto left = of_cell(std::max(a - 1, 0)), right = of_cell(std::min(a, columns - 2));
  if (!left || !right) return std::nullopt;
  return (*left + *right) / 2;
}

}  // namespace clothbench
