#include "xpbd/time/integrator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "clothbench/solver.hpp"
#include "clothbench/vector.hpp"
#include "xpbd/constraints.hpp"
#include "xpbd/mesh/edge_paths.hpp"
#include "xpbd/mesh/matrices.hpp"
#include "xpbd/time/rules.hpp"

namespace clothbench::pbd_gpu {

TimeStep time_step(bool uses_bdf2, double h_s, double last_h_s, double damping_per_s) {
  // A velocity is the mean of its step, so forces act from the middle of one step to the middle of the next.
  if (!uses_bdf2) {
    // In float32 as in the fused frame, so that both give bit-identical states.
    const float lengths = static_cast<float>(last_h_s) / static_cast<float>(h_s);
    return {h_s, 0, -std::expm1(-damping_per_s * h_s), 1, last_h_s > 0 ? 0.5 + 0.5 * static_cast<double>(lengths) : 1};
  }
  const double ratio = last_h_s > 0 && h_s <= rules::kMaxStepRatio * last_h_s ? h_s / last_h_s : 0;
  const double h = ratio > 0 ? h_s * (1 + ratio) / (1 + 2 * ratio) : h_s;
  const double force_scale = 1 / (1 + damping_per_s * h);
  return {h, ratio * ratio / (1 + 2 * ratio), 1 - force_scale, force_scale, 1};
}

namespace {

std::string tuned(const nlohmann::json& settings, const char* member) {
  return settings.value(kTuning, nlohmann::json::object()).value(member, "auto");
}

/// Distance [m] from a point to a static collider; for a mesh, to its nearest vertex.
double distance_to(const Collider& c, const Vec3& from) {
  const Vec3 to = minus(from, c.center_m);
  if (c.shape == Collider::Shape::Plane) return std::max(0.0, dot(to, c.normal));
  if (c.shape == Collider::Shape::Sphere) return std::max(0.0, norm(to) - c.radius_m);
  if (c.shape == Collider::Shape::Box) {
    Vec3 beyond{};
    for (std::size_t k = 0; k < 3; ++k) beyond[k] = std::max(0.0, std::abs(dot(c.axes[k], to)) - c.half_extent_m[k]);
    return norm(beyond);
  }
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; c.mesh && v < c.mesh->vertex_count(); ++v)
    smallest = std::min(smallest, norm(minus(vertex_at(c.mesh->positions, v), from)));
  return smallest;
}

/// Distance [m] from the cloth's centre beyond which no vertex gets while only gravity, links, pins and attachments
/// act: the largest at the start, plus twice the cloth's diagonal, plus the path of a fall from the initial velocity.
double reach_m(const Scene& s) {
  const Cloth& c = s.cloth;
  const std::vector<double> x = initial_positions(s);
  double start = 0;
  for (std::size_t v = 0; v < c.vertex_count(); ++v) start = std::max(start, norm(minus(vertex_at(x, v), c.center_m)));
  const double across = std::hypot(c.width_m, c.height_m), t = s.time.duration_s;
  const double speed = norm(c.initial_velocity_m_per_s) + norm(c.spin_rad_per_s) * across + grip_speed_m_per_s(s);
  return start + 2 * across + speed * t + 0.5 * norm(s.gravity_m_per_s2) * t * t;
}

/// True for a grid without shear stiffness: rows and columns have no diagonals that couple them.
bool is_strip(const Scene& s) { return !s.needs.has(Feature::Shear) && !s.needs.has(Feature::ClothMesh); }

/// True if a stretch wave crosses at most kMaxWaveOfCloth per substep. Inextensible links have no waves.
bool resolves_waves(const Scene& scene, int substeps) {
  double largest = scene.material.membrane_stiffness_N_per_m.value_or(0), lightest = 1;
  for (const StiffnessRegion& r : scene.material.regions)
    largest = std::max(largest, r.membrane_stiffness_N_per_m.value_or(0));
  for (const double factor : scene.cloth.mass_factors) lightest = std::min(lightest, factor);
  const double h = scene.time.dt() / substeps,
               speed = std::sqrt(largest / (lightest * scene.cloth.areal_density_kg_per_m2));
  return h * speed <= rules::kMaxWaveOfCloth * std::max(scene.cloth.width_m, scene.cloth.height_m);
}

/// h'^2 T / (m l) for the maximum tension T [N] of a link at a pin, at one substep per frame: the number that decides
/// whether tension may be explicit. The weight is assumed to hang evenly from the pinned vertices that have free
/// neighbours. If these are few, they are assumed to be on the border, where a vertex has half the mass.
double tension_number(const Scene& s) {
  const Cloth& c = s.cloth;
  if (s.pins.vertices.empty()) return 0;
  std::vector<std::uint8_t> pinned(c.vertex_count(), 0), carries(c.vertex_count(), 0);
  for (const std::uint32_t v : s.pins.vertices) pinned[v] = 1;
  for (const Edge& e : edges(c, EdgeKind::Structural))
    if (pinned[e.a] != pinned[e.b]) carries[pinned[e.a] != 0 ? e.a : e.b] = 1;
  const auto carrying = std::accumulate(carries.begin(), carries.end(), 0.0);
  if (carrying == 0) return 0;
  const std::vector<double> masses = vertex_masses(s);
  const double total = std::accumulate(masses.begin(), masses.end(), 0.0),
               link = c.mesh ? c.mesh->edge_m : std::min(c.du(), c.dv()),
               share = carrying < std::min(c.columns, c.rows) / 2.0 ? 0.5 : 1,
               inner = total / static_cast<double>(c.vertex_count()), h = 2.0 / 3 * s.time.dt();
  return h * h * total * norm(s.gravity_m_per_s2) / carrying / (share * inner * link);
}

/// True if tethers suffice without implicit tension: for inextensible cloth, whose tethers carry the load, and for
/// elastic cloth whose tension may be explicit.
bool may_leave_tension_to_tethers(const Scene& scene, int substeps) {
  return !scene.material.membrane_stiffness_N_per_m ||
         tension_number(scene) <= rules::kMaxExplicitTension * substeps * substeps;
}

/// True if pinned vertices hold a sheet taut along no line of links. No colour solves this line as a whole (`energy`).
bool is_taut_askew(const Scene& s) {
  const auto columns = static_cast<std::uint32_t>(s.cloth.columns);
  const std::vector<std::uint32_t>& pins = s.pins.vertices;
  if (s.cloth.mesh || pins.size() >= static_cast<std::size_t>(std::min(s.cloth.columns, s.cloth.rows))) return false;
  const auto apart = [](std::uint32_t a, std::uint32_t b) { return std::max(a, b) - std::min(a, b); };
  for (const std::uint32_t a : pins)
    for (const std::uint32_t b : pins)
      if (const auto u = apart(a % columns, b % columns), v = apart(a / columns, b / columns); u * v > 0 && u != v)
        return true;
  return false;
}

/// True if a single vertex holds the sheet.
bool hangs_in_folds(const Scene& s) { return s.pins.vertices.size() == 1 && s.grips.vertices.empty(); }

/// Whether held cloth may be second order in time with its number of substeps. A strip always may: each line is solved
/// exactly as one system. A sheet's colours are solved one after another, which leaves an error.
FeatureDecision second_order_decision(const Scene& scene, const nlohmann::json& settings) {
  if (is_strip(scene)) return {true, ""};
  if (is_taut_askew(scene)) return {false, "pins hold the sheet taut along no line of links, which would gain energy"};
  if (!scene.grips.vertices.empty() && !(grip_strain(scene) <= rules::kMaxGripStrain))
    return {false, "hands pull the sheet by more than half of their distance: its links would overshoot"};
  if (!resolves_waves(scene, xpbd_substeps(scene, settings)))
    return {false, "a wave crosses the sheet in too few substeps: stiff links would gain energy"};
  return {true, ""};
}

}  // namespace

bool is_held(const Scene& scene) { return !scene.pins.vertices.empty() || !scene.grips.vertices.empty(); }

bool is_contact_free(const Scene& scene) {
  if (scene.needs.has(Feature::SelfCollision)) return false;
  if (scene.colliders.empty()) return true;
  if (!scene.jumps.empty()) return false;
  const double reach = reach_m(scene);
  return std::all_of(scene.colliders.begin(), scene.colliders.end(), [&](const Collider& c) {
    return !c.moves() && !c.mesh && distance_to(c, scene.cloth.center_m) > reach + c.margin_m;
  });
}

double impact_speed_m_per_s(const Scene& scene) {
  if (is_held(scene) || scene.colliders.empty() || is_contact_free(scene)) return 0;
  double fall_m = std::numeric_limits<double>::infinity();
  for (const Collider& c : scene.colliders) {
    if (c.moves()) return 0;
    fall_m = std::min(fall_m, distance_to(c, scene.cloth.center_m));
  }
  return norm(scene.cloth.initial_velocity_m_per_s) + std::sqrt(2 * norm(scene.gravity_m_per_s2) * fall_m);
}

FeatureDecision tension_decision(const Scene& scene, const nlohmann::json& settings) {
  const std::string wanted = tuned(settings, "tension");
  if (membrane_decision(scene, settings).enabled)
    return {true, ""};  // the solve of triangles includes their tension, whatever the setting
  if (wanted == "never") return {false, "setting tuning.tension=never"};
  if (!is_contact_free(scene)) return {false, "the scene has contact"};
  if (wanted == "always") return {true, ""};
  if (settings.value("time_order", 2) < 2) return {false, "setting time_order=1"};
  if (!is_held(scene)) return {false, "nothing holds the cloth"};
  if (is_tethered(scene, settings) && scene.cloth.mass_factors.empty() &&
      may_leave_tension_to_tethers(scene, xpbd_substeps(scene, settings)))
    return {false, "tethers limit the stretch at lower cost"};
  if (!is_strip(scene) && starts_crumpled(scene)) return {false, "the sheet starts crumpled"};
  return second_order_decision(scene, settings);
}

FeatureDecision bdf2_decision(const Scene& scene, const nlohmann::json& settings) {
  const std::string wanted = tuned(settings, "bdf2");
  if (settings.value("time_order", 2) < 2 && wanted != "always") return {false, "setting time_order=1"};
  if (!is_contact_free(scene)) return {false, "the scene has contact, and the cloth would rebound"};
  if (wanted == "always") return {true, ""};
  if (starts_crumpled(scene)) return {false, "the cloth starts crumpled"};
  if (!is_held(scene)) return {true, ""};
  // Tethers suffice on a grid, whose last colour, the rows, contains all vertices; no colour of a mesh does.
  const FeatureDecision may = second_order_decision(scene, settings);
  if (may.enabled && scene.needs.has(Feature::ClothMesh) && !tension_decision(scene, settings).enabled)
    return {false, "a triangle mesh without implicit tension: single links would stretch far"};
  return may;
}

double substeps_for_splitting(const Scene& scene) {
  const Cloth& c = scene.cloth;
  const double way = 2.0 / 3 * scene.time.dt() *
                     std::sqrt(scene.material.membrane_stiffness_N_per_m.value_or(0) / c.areal_density_kg_per_m2);
  // by_tension: stiffness times tension at one substep per frame. Both factors are proportional to the squared step.
  const double cell = std::min(c.du(), c.dv()), by_tension = way * way / (cell * cell) * tension_number(scene),
               cells = hangs_in_folds(scene) ? rules::kMaxSplittingCellsOfFolds : rules::kMaxSplittingCells;
  return std::max(way / std::min(cells * cell, rules::kMaxSplittingOfSide * std::min(c.width_m, c.height_m)),
                  std::pow(by_tension / rules::kMaxStiffnessTimesTension, 0.25));
}

FeatureDecision may_correct_splitting(const Scene& scene, const nlohmann::json& settings) {
  const std::string wanted = tuned(settings, "splitting_correction");
  if (wanted == "never") return {false, "setting tuning.splitting_correction=never"};
  const Cloth& c = scene.cloth;
  if (!scene.material.membrane_stiffness_N_per_m) return {false, "the cloth is inextensible"};
  if (!scene.needs.has(Feature::Shear)) return {false, "the scene has no shear stiffness"};
  if (needs_chain_solver(scene) || !c.mass_factors.empty()) return {false, "links or masses are not all alike"};
  if (!is_contact_free(scene)) return {false, "the scene has contact"};
  if (wanted == "always") return {true, ""};
  if (!is_held(scene)) return {false, "nothing holds the cloth: no tension lasts"};
  if (settings.value("time_order", 2) < 2) return {false, "setting time_order=1"};
  if (!(std::abs(c.du() / c.dv() - 1) <= rules::kMaxSplittingOblong)) return {false, "cells are not square"};
  if (std::min(c.columns, c.rows) <= rules::kMinSplittingLinks)
    return {false, "fewer than four links across the cloth"};
  return {true, ""};
}

FeatureDecision splitting_correction_decision(const Scene& scene, const nlohmann::json& settings) {
  const FeatureDecision may = may_correct_splitting(scene, settings);
  if (!may.enabled || tuned(settings, "splitting_correction") == "always") return may;
  if (const FeatureDecision prediction = bdf2_decision(scene, settings); !prediction.enabled)
    return {false, "first order in time: " + prediction.reason};
  if (!(substeps_for_splitting(scene) <= xpbd_substeps(scene, settings)))
    return {false, "a wave crosses too many cells in a substep: the modulus of the sheet is below Y"};
  return {true, ""};
}

}  // namespace clothbench::pbd_gpu
