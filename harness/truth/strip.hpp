#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "clothbench/error.hpp"
#include "truth/reference_case.hpp"

// Used only by the reference cases, to check their requirements on a scene.
namespace clothbench::truth {

using Columns = std::vector<Vec3>;

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vec3 operator*(double k, const Vec3& a) { return {k * a[0], k * a[1], k * a[2]}; }

/// A scene as a strip, with checks that throw Error if a reference case's requirement is not met.
struct Strip {
  const Scene& scene;
  int links;
  double length_m, g;
  Vec3 start{}, along{}, up{};  // middle of edge u0; axis_u; against gravity

  explicit Strip(const Scene& s)
      : scene(s),
        links(s.cloth.mesh ? MaterialLattice::kSide - 1 : s.cloth.columns - 1),
        length_m(s.cloth.width_m),
        g(length(s.gravity_m_per_s2)) {
    along = s.cloth.axis_u;
    start = s.cloth.center_m - (s.cloth.span_m > 0 ? s.cloth.span_m : length_m) / 2 * along;
    if (g > 0) up = (-1 / g) * s.gravity_m_per_s2;
  }

  void need_rows(bool may_shear) const {
    need((scene.needs & FeatureSet{Feature::UnevenGrid, Feature::Regions, Feature::Spin}).empty(),
         "even cells and no spin");
    need(may_shear || !scene.needs.has(Feature::Shear),
         "\"shear\": false in its material, so that rows are independent");
    need(std::abs(dot(scene.cloth.axis_v, up)) <= kLevel, "axis_v at right angles to gravity");
  }

  void need(bool good, const std::string& what) const {
    if (!good) throw Error(scene.source + ": /truth/case: \"" + scene.reference_case + "\" requires " + what);
  }
  void need_gravity() const { need(g > 0, "gravity"); }
  void need_level() const {
    need_gravity();
    need(std::abs(dot(along, up)) <= kLevel, "a sheet whose axis_u is level");
  }
  void need_flat() const { need(scene.cloth.span_m == 0 && scene.cloth.drape_radius_m == 0, "a flat start"); }
  void need_rest() const { need(length(scene.cloth.initial_velocity_m_per_s) == 0, "a start at rest"); }
  /// Extra weight per unit width on edge u1, if masses are scaled there and nowhere else.
  double end_load_N_per_m() const {
    if (scene.cloth.mass_factors.empty()) return 0;
    const Cloth& c = scene.cloth;
    const double factor = c.mass_factors.back();
    for (std::size_t v = 0; v < c.mass_factors.size(); ++v)
      need(c.mass_factors[v] == ((v + 1) % static_cast<std::size_t>(c.columns) == 0 ? factor : 1),
           "masses scaled only on edge u1, all equally");
    return (factor - 1) * c.areal_density_kg_per_m2 * c.du() / 2 * g;
  }
  void need_even_masses() const { need(scene.cloth.mass_factors.empty(), "masses that are not scaled"); }
  void need_pins(std::vector<std::uint32_t> expected, const std::string& what) const {
    std::sort(expected.begin(), expected.end());
    need(scene.pins.vertices == expected && scene.grips.vertices.empty(), what);
  }
  void need_inextensible() const { need(!scene.material.membrane_stiffness_N_per_m, "an inextensible material"); }
  /// Requires that the membrane's own weight stretches it by at most this fraction of the length.
  void need_stiff(double strain, const std::string& text) const {
    const auto Y = scene.material.membrane_stiffness_N_per_m;
    need(!Y || scene.cloth.areal_density_kg_per_m2 * g * length_m / *Y <= strain,
         "a membrane that its own weight stretches by " + text + " at most");
  }
  double need_stiffness() const {
    need(scene.material.membrane_stiffness_N_per_m.has_value(), "a membrane stiffness in N/m");
    return *scene.material.membrane_stiffness_N_per_m;
  }
  void need_no_bending() const { need(!scene.needs.has(Feature::Bend), "no bending rigidity"); }
  void need_damping(bool damped) const {
    need(scene.needs.has(Feature::Damping) == damped, damped ? "damping, to come to rest" : "no damping");
  }
  bool mesh() const { return scene.cloth.mesh != nullptr; }
  /// Vertices of a mesh at most `u_m` from edge u0.
  std::vector<std::uint32_t> up_to(double u_m) const {
    std::vector<std::uint32_t> out;
    for (std::uint32_t v = 0; v < scene.cloth.vertex_count(); ++v)
      if (scene.cloth.mesh->vertices[v][0] + length_m / 2 <= u_m + kFlat * length_m) out.push_back(v);
    return out;
  }
  std::vector<std::uint32_t> edge(const char* name) const {
    return mesh() ? up_to(0) : edge_vertices(scene.cloth, name);
  }
  Vec3 at(double x, double z) const { return start + x * along + z * up; }
  double time_s(int frame) const { return scene.time.at(frame); }
  std::vector<double> times_s() const {
    std::vector<double> out;
    for (int f = 0; f <= scene.time.frames(); ++f) out.push_back(time_s(f));
    return out;
  }
  /// One position per column: `at(i)` for i from 0 to `links`.
  template <class At>
  Columns columns(At at) const {
    Columns out;
    for (int i = 0; i <= links; ++i) out.push_back(at(i));
    return out;
  }
  /// Mean of `value(i)` over the columns; the two end columns stand for half a cell.
  template <class Value>
  double mean(Value value) const {
    double sum = 0;
    for (int i = 0; i <= links; ++i) sum += (i == 0 || i == links ? 0.5 : 1) * value(static_cast<std::size_t>(i));
    return sum / links;
  }
  ReferenceCase reference_case() const {
    ReferenceCase c;
    c.name = scene.reference_case;
    c.quantity_scale = length_m;
    return c;
  }

  static constexpr double kLevel = 1e-9, kFlat = 1e-9;  ///< tolerances of directions, of positions over length
};

// strip_cases.cpp
ReferenceCase free_fall(const Strip&);
ReferenceCase pendulum(const Strip&);
ReferenceCase swing_strip(const Strip&);
ReferenceCase heavy_strip(const Strip&);
ReferenceCase cantilever(const Strip&);
ReferenceCase two_hand_pull(const Strip&);

// contact_cases.cpp
ReferenceCase incline(const Strip&);
ReferenceCase capstan(const Strip&);

}  // namespace clothbench::truth
