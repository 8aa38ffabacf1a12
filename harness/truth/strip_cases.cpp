// Reference cases without contact: the requirements of each on its scene, and its solution in scene coordinates.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "base/json_text.hpp"
#include "truth/solutions.hpp"
#include "truth/strip.hpp"

namespace clothbench::truth {
namespace {

// Inextensible triangles lock, so a mesh must be elastic, but so stiff that its stretch is small relative to its error.
constexpr double kMeshStrain = 1e-3;
constexpr const char* kMeshStrainText = "1e-3";

constexpr double kPoissonRatio = 1.0 / 3;  // every sheet with shear has this ratio
// Number of links of the chain that stands for a cantilever's continuum: off by 2.4e-7 of its length at Gamma = 10.
constexpr int kSmooth = 2048;

/// Positions of a sheet with shear: away from its pinned edge it also narrows, by a third of its strain.
std::vector<double> narrowed(const Strip& s, const HeavyStrip& strip, const Columns& columns) {
  const Cloth& c = s.scene.cloth;
  std::vector<double> out = vertex_values(c, columns);
  for (int j = 0; j < c.rows; ++j)
    for (int i = 1; i < c.columns; ++i) {
      const double below = strip.areal_density_kg_per_m2 * strip.gravity_m_per_s2 * (c.columns - 1 - i) * c.du(),
                   strain = (below + strip.end_load_N_per_m) / strip.membrane_stiffness_N_per_m,
                   by = strain * kPoissonRatio * (j * c.dv() - c.height_m / 2);
      for (std::size_t k = 0; k < 3; ++k) out[3 * static_cast<std::size_t>(j * c.columns + i) + k] -= by * c.axis_v[k];
    }
  return out;
}

/// Width [m] of a mesh's clamp at edge u0. Throws Error if only the edge is pinned, or any vertex outside the clamp.
double clamp_of_mesh_m(const Strip& s) {
  const Cloth& c = s.scene.cloth;
  double width_m = 0;
  for (const std::uint32_t v : s.scene.pins.vertices)
    width_m = std::max(width_m, c.mesh->vertices[v][0] + c.width_m / 2);
  s.need(width_m > Strip::kFlat * c.width_m && width_m < 0.5 * c.width_m,
         "a clamp: pinned vertices from edge u0 on, beyond it but over less than half of the width");
  s.need_pins(s.up_to(width_m), "every vertex from edge u0 to the end of the clamp pinned, and no other pins or grips");
  return width_m;
}

/// Two hands that pull symmetrically in opposite directions, as in the scene's file.
PullWave hands_of(const Strip& s) {
  const nlohmann::json grips = json_from(s.scene.json).at("grips");
  const auto velocity = [&](std::size_t k) {
    const nlohmann::json v = grips.at(k).value("velocity_m_per_s", nlohmann::json::array({0, 0, 0}));
    return Vec3{v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>()};
  };
  const char* kBars = "two grips: edge u0 moved along -axis_u and edge u1 along axis_u, equally fast, with one ramp_s";
  s.need(grips.size() == 2 && grips[0].value("edge", "") == "u0" && grips[1].value("edge", "") == "u1", kBars);
  const double speed = dot(velocity(1), s.along), ramp_s = grips[0].at("ramp_s").get<double>();
  const bool alike = length(velocity(0) + velocity(1)) <= 1e-9 * speed &&
                     length(velocity(1) - speed * s.along) <= 1e-9 * speed &&
                     grips[1].at("ramp_s").get<double>() == ramp_s;
  for (const nlohmann::json& grip : grips)
    for (const char* key : {"stop_s", "release_s", "jumps"})
      s.need(!grip.contains(key), std::string("bars without \"") + key + "\"");
  s.need_even_masses();
  s.need(speed > 0 && alike && s.scene.pins.vertices.empty(), kBars);
  return {s.length_m, std::sqrt(s.need_stiffness() / s.scene.cloth.areal_density_kg_per_m2), speed, ramp_s};
}

}  // namespace

ReferenceCase free_fall(const Strip& s) {
  s.need_gravity();
  s.need_even_masses();
  s.need_pins({}, "no pins and no grips");
  s.need_flat();
  ReferenceCase known = s.reference_case();
  const auto body = [c = s.scene.material.damping_per_s](double v, double g) { return FreeFall{v, g, c}; };
  known.quantity_scale = -fall_height_m(body(0, s.g), s.time_s(s.scene.time.frames()));
  const Vec3 v0 = s.scene.cloth.initial_velocity_m_per_s;
  const auto fallen = [s, v0, body](double share, int frame) {
    const double t = s.time_s(frame);
    return s.start + share * s.length_m * s.along + fall_height_m(body(1, 0), t) * v0 +
           fall_height_m(body(0, s.g), t) * s.up;
  };
  known.columns = [s, fallen](int frame) {
    return s.columns([&](int i) { return fallen(static_cast<double>(i) / s.links, frame); });
  };
  known.quantity = [s](const Columns& c) {
    const double height = s.mean([&](std::size_t i) { return dot(c[i] - s.start, s.up); });
    return -(height - s.length_m / 2 * dot(s.along, s.up));
  };
  return known;
}

ReferenceCase pendulum(const Strip& s) {
  s.need(s.links == 1, "one link: 2 columns");
  s.need_level();
  s.need_flat();
  s.need_rest();
  s.need_pins(s.edge("u0"), "edge u0 pinned, and no other pins or grips");
  s.need_inextensible();
  s.need_damping(false);
  s.need_even_masses();
  ReferenceCase known = s.reference_case();
  known.quantity_scale = std::numbers::pi / 2;
  // Only the free row moves, so its mass is a point pendulum.
  const Pendulum p{s.length_m, s.g, std::numbers::pi / 2};
  known.columns = [s, p](int frame) {
    const double a = pendulum_angle_rad(p, s.time_s(frame));
    return Columns{s.start, s.at(s.length_m * std::sin(a), -s.length_m * std::cos(a))};
  };
  known.quantity = [s](const Columns& c) {
    const Vec3 d = c.back() - s.start;
    return std::atan2(dot(d, s.along), -dot(d, s.up));
  };
  return known;
}

ReferenceCase swing_strip(const Strip& s) {
  s.need_level();
  s.need_flat();
  s.need_rest();
  s.need_pins(s.edge("u0"), "edge u0 pinned, and no other pins or grips");
  if (s.mesh())
    s.need_stiff(kMeshStrain, kMeshStrainText);
  else
    s.need_inextensible();
  s.need_no_bending();
  s.need_damping(false);
  s.need_even_masses();
  const double horizon_s = 0.5 * std::sqrt(s.length_m * 9.81 / s.g);
  s.need(s.time_s(s.scene.time.frames()) <= horizon_s * (1 + 1e-9),
         "a duration of at most 0.5 s sqrt(L/1 m 9.81/g): after it the motion is chaotic");
  ReferenceCase known = s.reference_case();
  known.quantity = [s](const Columns& c) { return dot(c.back() - s.start, s.along); };
  using States = std::vector<Nodes>;
  const auto states = std::make_shared<States>(swing({s.links, s.length_m, s.g, 0.5}, s.times_s()));
  known.columns = [s, states](int frame) {
    Columns out;
    for (const auto& [x, z] : states->at(static_cast<std::size_t>(frame))) out.push_back(s.at(x, z));
    return out;
  };
  // Four times as many links have a 16 times smaller error; computed only on request.
  const auto fine = std::make_shared<States>();
  known.continuum = [s, fine](double share, int frame) {
    if (fine->empty())
      *fine = swing({std::min((s.mesh() ? 8 : 4) * s.links, 512), s.length_m, s.g, 0.5}, s.times_s(), 1e-9);
    const auto [x, z] = node_position(fine->at(static_cast<std::size_t>(frame)), share);
    return s.at(x, z);
  };
  return known;
}

ReferenceCase heavy_strip(const Strip& s) {
  s.need_gravity();
  s.need(std::abs(dot(s.along, s.up) + 1) <= Strip::kLevel, "a sheet whose axis_u points down");
  s.need_flat();
  s.need_pins(s.edge("u0"), "edge u0 pinned, and no other pins or grips");
  s.need_no_bending();
  s.need_damping(true);
  ReferenceCase known = s.reference_case();
  known.settles = known.by_quantity = true;
  known.quantity = [s](const Columns& c) { return dot(c.back() - s.start, s.along) - s.length_m; };
  if (!s.scene.material.membrane_stiffness_N_per_m) {  // it stays at its start, whatever its masses
    known.columns = [s](int) { return s.columns([&](int i) { return s.at(s.length_m * i / s.links, 0); }); };
    return known;
  }
  const HeavyStrip strip{s.length_m, s.scene.cloth.areal_density_kg_per_m2, s.need_stiffness(), s.g,
                         s.end_load_N_per_m()};
  known.quantity_scale = hang_displacement_m(strip, s.length_m);
  const bool sheet = s.scene.needs.has(Feature::Shear);
  if (s.mesh() || sheet) {
    // The pinned edge keeps its width, so the half next to it is stiffer than a strip; the other half is not.
    known.quantity_scale -= hang_displacement_m(strip, s.length_m / 2);
    known.quantity = [s](const Columns& c) { return dot(c.back() - c[c.size() / 2], s.along) - s.length_m / 2; };
  }
  const auto hanging = [s, strip](double rest_m) { return s.at(rest_m + hang_displacement_m(strip, rest_m), 0); };
  known.columns = [s, hanging](int) { return s.columns([&](int i) { return hanging(s.length_m * i / s.links); }); };
  if (sheet)
    known.vertices = [s, strip, columns = known.columns](int frame) { return narrowed(s, strip, columns(frame)); };
  known.continuum = [s, hanging](double share, int) { return hanging(share * s.length_m); };
  return known;
}

ReferenceCase cantilever(const Strip& s) {
  s.need_level();
  s.need_flat();
  s.need(s.links >= 2, "3 columns or more");
  if (!s.mesh()) s.need_pins(clamp_vertices(s.scene.cloth, "u0"), "edge u0 clamped, and no other pins or grips");
  s.need_damping(true);
  s.need(s.scene.needs.has(Feature::Bend), "a bending rigidity");
  s.need_even_masses();
  s.mesh() ? s.need_stiff(kMeshStrain, kMeshStrainText) : s.need_stiff(1e-7, "1e-7");
  const double cell = s.mesh() ? clamp_of_mesh_m(s) : s.scene.cloth.du(), free_m = s.length_m - cell,
               weight = s.scene.cloth.areal_density_kg_per_m2 * s.g;
  const double gamma = weight * free_m * free_m * free_m / s.scene.material.bending_rigidity_N_m;
  s.need(gamma <= 1e4, "areal density * g * length^3 / bending rigidity of at most 1e4");
  ReferenceCase known = s.reference_case();
  known.settles = true;
  known.quantity_scale = free_m;
  known.quantity = [s](const Columns& c) { return dot(c.back() - s.start, -1 * s.up); };
  known.columns = [s, cell, free_m, nodes = cantilever_nodes(s.links - 1, gamma)](int) {
    Columns out = {s.start};
    for (const auto& [x, y] : nodes) out.push_back(s.at(cell + free_m * x, -free_m * y));
    return out;
  };
  known.continuum = [s, cell, free_m, nodes = cantilever_nodes(kSmooth, gamma)](double share, int) {
    const double rest = share * s.length_m;
    if (rest <= cell) return s.at(rest, 0);
    const auto [x, y] = node_position(nodes, std::min(1.0, (rest - cell) / free_m));
    return s.at(cell + free_m * x, -free_m * y);
  };
  return known;
}

ReferenceCase two_hand_pull(const Strip& s) {
  s.need(s.g == 0, "no gravity");
  s.need(s.links >= 2, "3 columns or more");
  s.need_flat();
  s.need_rest();
  s.need_no_bending();
  s.need_damping(false);
  const PullWave hands = hands_of(s);
  const auto displacement = [&](std::size_t held, const Vec3& from) {
    std::vector<double> out;
    for (const FrameMotion& m : s.scene.motion) out.push_back(dot(m.grip_position_m[held] - from, s.along));
    return out;
  };
  const std::size_t rows = static_cast<std::size_t>(s.scene.cloth.rows);
  const auto first = displacement(0, s.scene.motion[0].grip_position_m[0]),
             last = displacement(rows, s.scene.motion[0].grip_position_m[rows]);
  ReferenceCase known = s.reference_case();
  known.by_quantity = true;
  known.quantity_scale = hands.hand_speed_m_per_s / hands.wave_speed_m_per_s;
  using States = std::vector<std::vector<double>>;
  const auto states = std::make_shared<States>(
      pull({s.links, s.length_m, s.scene.cloth.areal_density_kg_per_m2, s.need_stiffness()}, s.times_s(), first, last));
  known.columns = [s, states](int frame) {
    const std::vector<double>& moved = states->at(static_cast<std::size_t>(frame));
    return s.columns([&](int i) { return s.at(s.length_m * i / s.links + moved[static_cast<std::size_t>(i)], 0); });
  };
  known.continuum = [s, hands](double share, int frame) {
    const double x = std::clamp(share - 0.5, -0.5, 0.5) * s.length_m;
    return s.at(share * s.length_m + hands.displacement_m(x, s.time_s(frame)), 0);
  };
  known.quantity = [cell = s.length_m / s.links](const Columns& c) {
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < c.size(); ++i) most = max_or_nan(most, length(c[i + 1] - c[i]) / cell - 1);
    return most;
  };
  return known;
}

}  // namespace clothbench::truth
