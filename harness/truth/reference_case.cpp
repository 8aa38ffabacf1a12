#include "truth/reference_case.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "clothbench/error.hpp"
#include "truth/case_strip.hpp"
#include "truth/catenary.hpp"
#include "truth/discrete_elastica.hpp"
#include "truth/elastica.hpp"
#include "truth/free_fall.hpp"
#include "truth/heavy_stretch.hpp"
#include "truth/pendulum.hpp"
#include "truth/pull_chain.hpp"
#include "truth/pull_wave.hpp"
#include "truth/swinging_chain.hpp"

namespace clothbench::truth {
namespace {

// Inextensible triangles lock: a mesh is elastic, and so stiff that its stretch is small beside its own error.
constexpr double kMeshStrain = 1e-3;
constexpr const char* kMeshStrainText = "1e-3";

/// Distance of the last column from the middle of edge u0 along `direction`.
std::function<double(const Columns&)> tip(const Vec3& start, const Vec3& direction) {
  return [=](const Columns& c) { return dot(c.back() - start, direction); };
}

ReferenceCase free_fall(const Strip& s) {
  s.need_gravity();
  s.need_even_masses();
  s.need_pins({}, "nothing that is held");
  s.need_flat();
  ReferenceCase known = s.reference_case();
  known.quantity_name = "fall of the centre of mass";
  const auto body = [c = s.scene.material.damping_per_s](double v, double g) { return FreeFall{0, v, g, c}; };
  known.quantity_scale = -fall_height_m(body(0, s.g), s.time_s(s.scene.time.frames()));
  const Vec3 v0 = s.scene.cloth.initial_velocity_m_per_s;
  const auto fallen = [s, v0, body](double share, int frame) {
    const double t = s.time_s(frame);
    return s.start + share * s.length_m * s.along + fall_height_m(body(1, 0), t) * v0 +
           fall_height_m(body(0, s.g), t) * s.up;
  };
  known.columns = [s, fallen](int frame) {
    Columns out;
    for (int i = 0; i <= s.links; ++i) out.push_back(fallen(static_cast<double>(i) / s.links, frame));
    return out;
  };
  known.column_speeds = [s, v0, body](int frame) {
    const double t = s.time_s(frame);
    const Vec3 v = fall_speed_m_per_s(body(1, 0), t) * v0 + fall_speed_m_per_s(body(0, s.g), t) * s.up;
    return Columns(static_cast<std::size_t>(s.links) + 1, v);
  };
  known.quantity = [s](const Columns& c) {
    double sum = 0;  // ends carry half a cell
    for (std::size_t i = 0; i < c.size(); ++i)
      sum += (i == 0 || i + 1 == c.size() ? 0.5 : 1) * dot(c[i] - s.start, s.up);
    return -(sum / s.links - s.length_m / 2 * dot(s.along, s.up));
  };
  return known;
}

ReferenceCase pendulum(const Strip& s) {
  s.need(s.links == 1, "one link: 2 columns");
  s.need_level();
  s.need_flat();
  s.need_rest();
  s.need_pins(s.edge("u0"), "edge u0 pinned and nothing else held");
  s.need_inextensible();
  s.need_damping(false);
  s.need_even_masses();
  ReferenceCase known = s.reference_case();
  known.quantity_name = "angle from the vertical";
  known.quantity_scale = std::numbers::pi / 2;
  // Only the free row's mass moves: a point pendulum.
  const Pendulum p{s.length_m, s.g, std::numbers::pi / 2};
  known.columns = [s, p](int frame) {
    const double a = pendulum_angle_rad(p, s.time_s(frame));
    return Columns{s.start, s.at(s.length_m * std::sin(a), -s.length_m * std::cos(a))};
  };
  known.column_speeds = [s, p](int frame) {
    const double a = pendulum_angle_rad(p, s.time_s(frame)),
                 w = s.length_m * pendulum_angular_speed_rad_per_s(p, s.time_s(frame));
    return Columns{Vec3{}, w * std::cos(a) * s.along + w * std::sin(a) * s.up};
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
  s.need_pins(s.edge("u0"), "edge u0 pinned and nothing else held");
  if (s.mesh())
    s.need_stiff(kMeshStrain, kMeshStrainText);
  else
    s.need_inextensible();
  s.need_no_bending();
  s.need_damping(false);
  s.need_even_masses();
  const double horizon_s = 0.5 * std::sqrt(s.length_m * 9.81 / s.g);
  s.need(s.time_s(s.scene.time.frames()) <= horizon_s * (1 + 1e-9),
         "a duration of at most 0.5 s sqrt(L/1 m 9.81/g): then comes chaos");
  ReferenceCase known = s.reference_case();
  known.quantity_name = "distance of the free end from the wall";
  known.quantity = tip(s.start, s.along);
  using States = std::vector<ChainState>;
  const auto states = std::make_shared<States>(swing({s.links, s.length_m, s.g, 0.5, 0}, s.times_s()));
  known.columns = [s, states](int frame) {
    const ChainState& now = states->at(static_cast<std::size_t>(frame));
    Columns out;
    for (std::size_t i = 0; i < now.x_m.size(); ++i) out.push_back(s.at(now.x_m[i], now.z_m[i]));
    return out;
  };
  known.column_speeds = [s, states](int frame) {
    const ChainState& now = states->at(static_cast<std::size_t>(frame));
    Columns out;
    for (std::size_t i = 0; i < now.x_m.size(); ++i)
      out.push_back(now.x_speed_m_per_s[i] * s.along + now.z_speed_m_per_s[i] * s.up);
    return out;
  };
  // Four times as many links are nearer to the continuum by 16; made only if asked for.
  const auto fine = std::make_shared<States>();
  known.continuum = [s, fine](double share, int frame) {
    if (fine->empty())
      *fine = swing({std::min((s.mesh() ? 8 : 4) * s.links, 512), s.length_m, s.g, 0.5, 0}, s.times_s(), 1e-9);
    const auto [x, z] = chain_position_m(fine->at(static_cast<std::size_t>(frame)), share);
    return s.at(x, z);
  };
  return known;
}

/// A strip that does not stretch stays where it starts, whatever its masses.
ReferenceCase hanging_at_rest_length(const Strip& s) {
  ReferenceCase known = s.reference_case();
  known.settles = known.by_quantity = true;
  known.quantity_name = "stretch of the strip";
  known.quantity = [s](const Columns& c) { return dot(c.back() - s.start, s.along) - s.length_m; };
  known.columns = [s](int) {
    Columns out;
    for (int i = 0; i <= s.links; ++i) out.push_back(s.at(s.length_m * i / s.links, 0));
    return out;
  };
  return known;
}

ReferenceCase heavy_strip(const Strip& s) {
  s.need_gravity();
  s.need(std::abs(dot(s.along, s.up) + 1) <= Strip::kLevel, "a sheet whose axis_u points down");
  s.need_flat();
  s.need_pins(s.edge("u0"), "edge u0 pinned and nothing else held");
  s.need_no_bending();
  s.need_damping(true);
  if (!s.scene.material.membrane_stiffness_N_per_m) return hanging_at_rest_length(s);
  const HeavyStrip strip{s.length_m, s.scene.cloth.areal_density_kg_per_m2, s.need_stiffness(), s.g,
                         s.end_load_N_per_m()};
  ReferenceCase known = s.reference_case();
  known.settles = known.by_quantity = true;
  known.quantity_name = "stretch of the strip";
  known.quantity_scale = hang_displacement_m(strip, s.length_m);
  known.quantity = [s](const Columns& c) { return dot(c.back() - s.start, s.along) - s.length_m; };
  if (s.mesh()) {
    // The pinned edge keeps its width. The half at it is therefore stiffer than a strip, the other one is not.
    known.quantity_name = "stretch of the lower half";
    known.quantity_scale -= hang_displacement_m(strip, s.length_m / 2);
    known.quantity = [s](const Columns& c) { return dot(c.back() - c[c.size() / 2], s.along) - s.length_m / 2; };
  }
  known.columns = [s, strip](int) {
    Columns out;
    for (int i = 0; i <= s.links; ++i)
      out.push_back(s.at(s.length_m * i / s.links + hang_row_displacement_m(strip, s.links, i), 0));
    return out;
  };
  known.continuum = [s, strip](double share, int) {
    return s.at(share * s.length_m + hang_displacement_m(strip, share * s.length_m), 0);
  };
  return known;
}

ReferenceCase catenary(const Strip& s) {
  s.need_level();
  s.need(s.scene.cloth.span_m > 0, "\"span_m\" in its pose: the distance of its two pinned edges");
  std::vector<std::uint32_t> ends = s.edge("u0");
  for (std::uint32_t v : s.edge("u1")) ends.push_back(v);
  s.need_pins(ends, "edges u0 and u1 pinned and nothing else held");
  s.need_inextensible();
  s.need_no_bending();
  s.need_damping(true);
  s.need_even_masses();
  ReferenceCase known = s.reference_case();
  known.settles = true;
  known.quantity_name = "sag";
  known.quantity = [s](const Columns& c) {
    double sag = -std::numeric_limits<double>::infinity();
    for (const Vec3& x : c) sag = greater(sag, -dot(x - s.start, s.up));
    return sag;
  };
  known.columns = [s, nodes = DiscreteCatenary(s.links, s.length_m, s.scene.cloth.span_m).nodes_m()](int) {
    Columns out;
    for (const auto& [x, z] : nodes) out.push_back(s.at(x, z));
    return out;
  };
  known.continuum = [s, smooth = Catenary(s.length_m, s.scene.cloth.span_m)](double share, int) {
    const auto [x, z] = smooth.position_m(share * s.length_m);
    return s.at(x, z);
  };
  return known;
}

ReferenceCase cantilever(const Strip& s) {
  s.need_level();
  s.need_flat();
  s.need(s.links >= 2, "3 columns or more");
  if (!s.mesh()) s.need_pins(clamp_vertices(s.scene.cloth, "u0"), "edge u0 clamped and nothing else held");
  s.need_damping(true);
  s.need(s.scene.needs.has(Feature::Bend), "a bending rigidity");
  s.need_even_masses();
  s.mesh() ? s.need_stiff(kMeshStrain, kMeshStrainText) : s.need_stiff(1e-7, "1e-7");
  const double cell = s.mesh() ? need_mesh_clamp(s) : s.scene.cloth.du(), free_m = s.length_m - cell,
               weight = s.scene.cloth.areal_density_kg_per_m2 * s.g;
  const double gamma = weight * free_m * free_m * free_m / s.scene.material.bending_rigidity_N_m;
  ReferenceCase known = s.reference_case();
  known.settles = true;
  known.quantity_name = "drop of the free end";
  known.quantity_scale = free_m;
  known.quantity = tip(s.start, -1 * s.up);
  DiscreteElasticaLoad load;
  load.links = s.links - 1;
  load.own_weight = gamma;
  load.model = BendingModel::Line;
  known.columns = [s, cell, free_m, nodes = DiscreteElastica(load).nodes()](int) {
    Columns out = {s.start};
    for (const auto& [x, y] : nodes) out.push_back(s.at(cell + free_m * x, -free_m * y));
    return out;
  };
  ElasticaLoad smooth;
  smooth.own_weight = gamma;
  known.continuum = [s, cell, free_m, shape = std::make_shared<Elastica>(smooth)](double share, int) {
    const double rest = share * s.length_m;
    if (rest <= cell) return s.at(rest, 0);
    const auto [x, y] = shape->position(std::min(1.0, (rest - cell) / free_m));
    return s.at(cell + free_m * x, -free_m * y);
  };
  return known;
}

}  // namespace

TwoHandPull bars_of(const Strip& s) {
  const nlohmann::json grips = nlohmann::json::parse(s.scene.json).at("grips");
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
  return {s.length_m, s.scene.cloth.areal_density_kg_per_m2, s.need_stiffness(), speed, ramp_s};
}

namespace {

ReferenceCase two_hand_pull(const Strip& s) {
  s.need(s.g == 0, "no gravity");
  s.need(s.links >= 2, "3 columns or more");
  s.need_flat();
  s.need_rest();
  s.need_no_bending();
  s.need_damping(false);
  const TwoHandPull hands = bars_of(s);
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
  known.speed_scale_m_per_s = hands.hand_speed_m_per_s;
  known.quantity_name = "greatest strain";
  known.quantity_scale = hands.hand_speed_m_per_s / wave_speed_m_per_s(hands);
  const auto states = std::make_shared<std::vector<PulledState>>(
      pull({s.links, s.length_m, hands.areal_density_kg_per_m2, hands.membrane_stiffness_N_per_m}, s.times_s(), first,
           last));
  known.columns = [s, states](int frame) {
    Columns out;
    for (int i = 0; i <= s.links; ++i)
      out.push_back(s.at(s.length_m * i / s.links +
                             states->at(static_cast<std::size_t>(frame)).displacement_m[static_cast<std::size_t>(i)],
                         0));
    return out;
  };
  known.column_speeds = [s, states](int frame) {
    Columns out;
    for (double v : states->at(static_cast<std::size_t>(frame)).speed_m_per_s) out.push_back(v * s.along);
    return out;
  };
  known.continuum = [s, hands](double share, int frame) {
    const double x = std::clamp(share - 0.5, -0.5, 0.5) * s.length_m;
    return s.at(share * s.length_m + pull_displacement_m(hands, x, s.time_s(frame)), 0);
  };
  known.quantity = [cell = s.length_m / s.links](const Columns& c) {
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < c.size(); ++i) most = greater(most, length(c[i + 1] - c[i]) / cell - 1);
    return most;
  };
  return known;
}

}  // namespace

namespace {

ReferenceCase mesh_case(const Strip& s) {
  need_rectangle(s);
  if (s.scene.reference_case == "swing-strip") return on_mesh(s, swing_strip(s));
  if (s.scene.reference_case == "heavy-strip") return on_mesh(s, heavy_strip(s));
  s.need(s.scene.reference_case == "cantilever", "a cloth that is a grid");
  return on_mesh(s, cantilever(s));
}

}  // namespace

std::optional<ReferenceCase> reference_case_of(const Scene& scene) {
  if (scene.reference_case.empty()) return std::nullopt;
  const Strip s(scene);
  if (scene.reference_case == "incline") return incline(s);
  if (scene.reference_case == "swing-sheet") return swing_sheet(s);
  if (scene.reference_case == "pulled-sheet") return pulled_sheet(s);
  s.need_rows();
  if (scene.reference_case == "capstan") return capstan(s);
  if (scene.reference_case == "atwood") return atwood(s);
  s.need((scene.needs & kColliderFeatures).empty(), "no collider");
  if (scene.cloth.mesh) return mesh_case(s);
  if (scene.reference_case == "free-fall") return free_fall(s);
  if (scene.reference_case == "pendulum") return pendulum(s);
  if (scene.reference_case == "swing-strip") return swing_strip(s);
  if (scene.reference_case == "heavy-strip") return heavy_strip(s);
  if (scene.reference_case == "catenary") return catenary(s);
  if (scene.reference_case == "cantilever") return cantilever(s);
  if (scene.reference_case == "two-hand-pull") return two_hand_pull(s);
  throw Error(scene.source + ": /truth/case: no reference case \"" + scene.reference_case + "\"");
}

std::string ranking_of(const std::string& known) {
  if (known == "heavy-strip") return "stretch of the strip at rest / exact stretch";
  if (known == "two-hand-pull") return "greatest strain, RMS over time / (v0/c)";
  if (known == "incline") return "displacement along the slope, RMS over time / displacement at the end (at rest: L)";
  if (known == "capstan" || known == "atwood")
    return "displacement over the cylinder, RMS over time / displacement at the end (at rest: L)";
  return known == "catenary" || known == "cantilever" ? "RMS distance at rest / L"
                                                      : "RMS distance over space and time / L";
}

std::vector<Vec3> column_means(const Cloth& c, const std::vector<double>& values) {
  if (values.size() != 3 * c.vertex_count()) throw Error("argument values: expected 3 for each vertex");
  const std::vector<double> on_lattice = c.mesh ? sampler_of(c).sample(values) : std::vector<double>();
  const std::vector<double>& of = c.mesh ? on_lattice : values;
  Columns out(static_cast<std::size_t>(c.mesh ? MaterialLattice::kSide : c.columns));
  const double rows = c.mesh ? MaterialLattice::kSide : c.rows;
  for (std::size_t v = 0; v < of.size() / 3; ++v)
    for (std::size_t k = 0; k < 3; ++k) out[v % out.size()][k] += of[3 * v + k] / rows;
  return out;
}

std::vector<double> vertex_positions(const Cloth& c, const ReferenceCase& known, int frame) {
  return known.vertices ? known.vertices(frame) : vertex_values(c, known.columns(frame), true);
}

std::vector<double> vertex_values(const Cloth& c, const std::vector<Vec3>& columns, bool offset) {
  if (columns.size() != static_cast<std::size_t>(c.columns))
    throw Error("argument columns: expected one for each column of the grid");
  std::vector<double> out;
  for (int j = 0; j < c.rows; ++j)
    for (const Vec3& x : columns)
      for (std::size_t k = 0; k < 3; ++k)
        out.push_back(x[k] + (offset ? (j * c.dv() - c.height_m / 2) * c.axis_v[k] : 0));
  return out;
}

}  // namespace clothbench::truth
