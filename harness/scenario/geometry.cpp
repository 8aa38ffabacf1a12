#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "clothbench/scene.hpp"
#include "clothbench/vector.hpp"

namespace clothbench {
namespace {

/// Width [cells] that grid line `i` of `n` stands for: 1, or 0.5 at the border.
double share(int i, int n) { return i == 0 || i == n - 1 ? 0.5 : 1.0; }

/// Angle d between neighbouring chords of an arc of n equal chords if the arc's ends are `span` chords apart. Solves
/// sin(n d/2) / sin(d/2) = span; the left side falls from n at d = 0 to 0 at d = 2 pi/n.
double chord_angle(int n, double span) {
  double low = 0, high = 2 * std::numbers::pi / n;
  for (int k = 0; k < 200 && low < high; ++k) {
    const double d = low + (high - low) / 2;
    if (d == low || d == high) break;
    (std::sin(n * d / 2) > span * std::sin(d / 2) ? low : high) = d;
  }
  return high;
}

/// Position [m] of grid line `i` on an arc whose cells are equal chords of a circle. First: along the chord between the
/// arc's ends, from that chord's middle. Second: depth below that chord.
std::pair<double, double> on_arc(const Cloth& c, int i) {
  const int n = c.columns - 1;
  const double d = chord_angle(n, c.span_m / c.du()), radius = c.du() / (2 * std::sin(d / 2));
  return {radius * std::sin((i - n / 2.0) * d), radius * (std::cos((i - n / 2.0) * d) - std::cos(n * d / 2))};
}

Vec3 normal_of(const Cloth& c) { return cross(c.axis_u, c.axis_v); }

double hypot_of(const Vec3& a) { return std::hypot(a[0], a[1], a[2]); }

std::vector<double> mesh_masses(const Cloth& c) {
  std::vector<double> mass(c.vertex_count(), 0);
  for (std::size_t n = 0; n < c.mesh->triangles.size(); ++n) {
    const auto& t = c.mesh->triangles[n];
    const std::array<Vec3, 3> x = rest_corners(*c.mesh, n);
    const double area = 0.5 * hypot_of(cross(minus(x[1], x[0]), minus(x[2], x[0])));
    for (const std::uint32_t v : t) mass[v] += c.areal_density_kg_per_m2 * area / 3;
  }
  for (std::size_t v = 0; v < c.mass_factors.size(); ++v) mass[v] *= c.mass_factors[v];
  return mass;
}

/// The grid line `inwards` lines away from an edge.
std::vector<std::uint32_t> grid_line(const Cloth& c, const std::string& edge, int inwards) {
  const bool along_v = edge[0] == 'u';
  const int last = (along_v ? c.columns : c.rows) - 1, fixed = edge[1] == '0' ? inwards : last - inwards;
  std::vector<std::uint32_t> out;
  for (int k = 0; k < (along_v ? c.rows : c.columns); ++k)
    out.push_back(static_cast<std::uint32_t>(along_v ? k * c.columns + fixed : fixed * c.columns + k));
  return out;
}

bool jumps_at(const Scene& scene, std::size_t frame) {
  return std::any_of(scene.jumps.begin(), scene.jumps.end(),
                     [&](const Jump& j) { return static_cast<std::size_t>(j.frame) == frame; });
}

std::vector<double> speeds_of(const Scene& scene, bool with_recorded) {
  constexpr std::size_t kLooked = 64;
  std::vector<double> most(scene.motion.size(), 0);
  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    const Collider& c = scene.colliders[k];
    if (!c.moves() || (c.recorded && !with_recorded)) continue;
    ColliderMesh some;
    if (c.mesh)
      for (std::size_t v = 0; v < c.mesh->vertex_count();
           v += std::max<std::size_t>(1, c.mesh->vertex_count() / kLooked)) {
        some.positions.insert(some.positions.end(), &c.mesh->positions[3 * v], &c.mesh->positions[3 * v] + 3);
        some.joints.push_back(c.mesh->joints[v]);
        some.weights.push_back(c.mesh->weights[v]);
        some.joint_count = c.mesh->joint_count;
      }
    const auto points = [&](const ColliderPose& pose) {
      if (c.mesh) return posed_positions(some, pose);
      std::vector<double> x;
      for (const Capsule& s : pose.capsules)
        for (const Vec3& p : {s.a_m, s.b_m}) x.insert(x.end(), p.begin(), p.end());
      return x;
    };
    for (std::size_t f = 1; f < scene.motion.size(); ++f) {
      if (jumps_at(scene, f)) continue;
      const std::vector<double> was = points(scene.motion[f - 1].colliders[k]),
                                is = points(scene.motion[f].colliders[k]);
      const double dt = scene.time.dt_after(static_cast<int>(f) - 1);
      for (std::size_t x = 0; x < is.size() / 3; ++x)
        most[f] = std::max(most[f], hypot_of(minus(vertex_at(is, x), vertex_at(was, x))) / dt);
    }
  }
  return most;
}

std::vector<double> grip_speeds(const Scene& scene) {
  std::vector<double> most(scene.motion.size(), 0);
  for (std::size_t f = 1; f < scene.motion.size(); ++f) {
    const double dt = scene.time.dt_after(static_cast<int>(f) - 1);
    for (std::size_t g = 0; g < scene.motion[f].grip_position_m.size(); ++g) {
      const Vec3 &a = scene.motion[f - 1].grip_position_m[g], &b = scene.motion[f].grip_position_m[g];
      if (scene.motion[f].grip_held[g] != 0) most[f] = std::max(most[f], hypot_of(minus(b, a)) / dt);
    }
  }
  return most;
}

double greatest(const std::vector<double>& speeds) {
  return speeds.empty() ? 0 : *std::max_element(speeds.begin(), speeds.end());
}

}  // namespace

double Cloth::line_u_m(int i) const {
  if (column_factors.empty()) return i * du();
  double before = 0, all = 0;
  for (std::size_t k = 0; k < column_factors.size(); ++k) {
    all += column_factors[k];
    if (k < static_cast<std::size_t>(i)) before += column_factors[k];
  }
  return i + 1 == columns ? width_m : width_m * (before / all);
}

Vec3 Scene::rest_position(int i, int j) const {
  Vec3 at = cloth.mesh ? cloth.mesh->vertices[static_cast<std::size_t>(i)]
                       : Vec3{cloth.line_u_m(i) - cloth.width_m / 2, j * cloth.dv() - cloth.height_m / 2, 0};
  if (cloth.drape_radius_m > 0) return plus(draped_row(cloth, i, cloth.drape_offset_m), scaled(at[1], cloth.axis_v));
  if (cloth.span_m > 0) std::tie(at[0], at[2]) = on_arc(cloth, i);
  const Vec3 in_plane = plus(plus(cloth.center_m, scaled(at[0], cloth.axis_u)), scaled(at[1], cloth.axis_v));
  return plus(in_plane, scaled(at[2], normal_of(cloth)));
}

std::array<Vec3, 3> rest_corners(const ClothMesh& m, std::size_t triangle) {
  const auto& t = m.triangles[triangle];
  if (m.pattern_m.empty()) return {m.vertices[t[0]], m.vertices[t[1]], m.vertices[t[2]]};
  std::array<Vec3, 3> out{};
  for (std::size_t c = 0; c < 3; ++c) out[c] = {m.pattern_m[triangle][c][0], m.pattern_m[triangle][c][1], 0};
  return out;
}

double drape_turn_rad(const Cloth& c) { return 2 * std::asin(c.du() / (2 * c.drape_radius_m)); }

Vec3 draped_row(const Cloth& c, int i, double offset_m) {
  // Angles count from the horizontal on side u0. A row less than turn / 2 below the axis has the same distance from the
  // axis whether it hangs or touches, so both rules agree there.
  const double turn = drape_turn_rad(c), middle = (c.columns - 1) / 2.0 - offset_m / c.du();
  const auto angle_of = [&](double row) { return std::numbers::pi / 2 + (row - middle) * turn; };
  const double slack = 1e-9 * turn;
  const int first = static_cast<int>(std::ceil(middle - (std::numbers::pi / 2 + turn / 2 - slack) / turn)),
            last = static_cast<int>(std::floor(middle + (std::numbers::pi / 2 + turn / 2 - slack) / turn));
  const int on = std::clamp(i, first, last);
  const double angle = angle_of(on), hang = std::abs(i - on) * c.du();
  return plus(minus(c.center_m, scaled(c.drape_radius_m * std::cos(angle), c.axis_u)),
              scaled(hang - c.drape_radius_m * std::sin(angle), normal_of(c)));
}

std::vector<std::uint32_t> edge_vertices(const Cloth& c, const std::string& edge) { return grid_line(c, edge, 0); }

std::vector<std::uint32_t> clamp_vertices(const Cloth& c, const std::string& edge) {
  std::vector<std::uint32_t> out = grid_line(c, edge, 0);
  for (std::uint32_t v : grid_line(c, edge, 1)) out.push_back(v);
  return out;
}

std::vector<double> vertex_masses(const Scene& scene) {
  const Cloth& c = scene.cloth;
  if (c.mesh) return mesh_masses(c);
  const double cell = c.areal_density_kg_per_m2 * c.du() * c.dv();
  std::vector<double> mass;
  mass.reserve(c.vertex_count());
  // Half the width of each neighbouring cell. Equal cells use share(), so that rounding does not change them.
  const auto width = [&](int i) {
    if (c.column_factors.empty()) return share(i, c.columns);
    return (c.line_u_m(std::min(i + 1, c.columns - 1)) - c.line_u_m(std::max(i - 1, 0))) / 2 / c.du();
  };
  std::vector<double> widths;
  for (int i = 0; i < c.columns; ++i) widths.push_back(width(i));
  for (int j = 0; j < c.rows; ++j)
    for (int i = 0; i < c.columns; ++i) mass.push_back(cell * widths[static_cast<std::size_t>(i)] * share(j, c.rows));
  for (std::size_t v = 0; v < c.mass_factors.size(); ++v) mass[v] *= c.mass_factors[v];
  return mass;
}

double Cloth::least_height_m() const {
  double least = std::numeric_limits<double>::infinity();
  if (mesh)
    for (std::size_t k = 0; k < mesh->triangles.size(); ++k) {
      const auto [a, b, p] = rest_corners(*mesh, k);
      const Vec3 u = minus(b, a), v = minus(p, a);
      least = std::min(least, hypot_of(cross(u, v)) / std::max({hypot_of(u), hypot_of(v), hypot_of(minus(v, u))}));
    }
  else
    for (int i = 0; i + 1 < columns; ++i) {
      const double du = line_u_m(i + 1) - line_u_m(i);
      least = std::min(least, du * dv() / std::hypot(du, dv()));
    }
  return least;
}

std::vector<std::array<std::uint32_t, 3>> triangles(const Cloth& c) {
  if (c.mesh) return c.mesh->triangles;
  std::vector<std::array<std::uint32_t, 3>> out;
  out.reserve(2u * (c.columns - 1) * (c.rows - 1));
  for (int j = 0; j + 1 < c.rows; ++j)
    for (int i = 0; i + 1 < c.columns; ++i) {
      const auto a = static_cast<std::uint32_t>(j * c.columns + i), b = a + 1, d = a + c.columns, e = d + 1;
      out.push_back({a, b, e});
      out.push_back({a, e, d});
    }
  return out;
}

std::vector<Edge> edges(const Cloth& c, EdgeKind kind) {
  if (c.mesh) return kind == EdgeKind::Structural ? c.mesh->edges : std::vector<Edge>{};
  struct Step {
    int di, dj;
  };
  const int far = kind == EdgeKind::SkipOne ? 2 : 1;
  const std::array<Step, 2> steps =
      kind == EdgeKind::Shear ? std::array{Step{1, 1}, Step{-1, 1}} : std::array{Step{far, 0}, Step{0, far}};
  std::vector<Edge> out;
  for (const Step& s : steps) {
    const double even = std::hypot(s.di * c.du(), s.dj * c.dv());
    const auto rest = [&](int i) {
      return c.column_factors.empty() ? even : std::hypot(c.line_u_m(i + s.di) - c.line_u_m(i), s.dj * c.dv());
    };
    for (int j = 0; j + s.dj < c.rows; ++j)
      for (int i = std::max(0, -s.di); i + std::max(0, s.di) < c.columns; ++i)
        out.push_back({static_cast<std::uint32_t>(j * c.columns + i),
                       static_cast<std::uint32_t>((j + s.dj) * c.columns + i + s.di), rest(i), kind});
  }
  return out;
}

std::vector<double> driving_speeds_m_per_s(const Scene& scene) {
  std::vector<double> most = speeds_of(scene, true);
  const std::vector<double> held = grip_speeds(scene);
  std::transform(most.begin(), most.end(), held.begin(), most.begin(),
                 [](double a, double b) { return std::max(a, b); });
  return most;
}

double collider_speed_m_per_s(const Scene& scene) { return greatest(speeds_of(scene, true)); }

double scripted_collider_speed_m_per_s(const Scene& scene) { return greatest(speeds_of(scene, false)); }

double grip_speed_m_per_s(const Scene& scene) { return greatest(grip_speeds(scene)); }

double grip_strain(const Scene& scene) {
  if (scene.motion.empty()) return 0;
  const auto apart = [](const FrameMotion& m, std::size_t g) {
    return hypot_of(minus(m.grip_position_m[g], m.grip_position_m[0]));
  };
  const FrameMotion& start = scene.motion.front();
  double most = 0;
  for (const FrameMotion& m : scene.motion)
    for (std::size_t g = 1; g < m.grip_position_m.size(); ++g)
      if (m.grip_held[0] != 0 && m.grip_held[g] != 0 && apart(start, g) > 0)
        most = std::max(most, apart(m, g) / apart(start, g) - 1);
  return most;
}

}  // namespace clothbench
