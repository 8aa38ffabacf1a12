#include "prediction.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "chain_plan.hpp"
#include "clothbench/solver.hpp"
#include "crumpled.hpp"
#include "line_plan.hpp"

namespace clothbench::pbd_gpu {

TimeStep time_step(bool predicts, double h_s, double last_h_s, double damping_per_s) {
  if (!predicts) return {h_s, 0, -std::expm1(-damping_per_s * h_s), 1};
  // BDF2 with variable steps is zero-stable below a ratio of 1 + sqrt(2) (Hairer, Norsett & Wanner, Solving Ordinary
  // Differential Equations I, section III.5); above 2 the history says little, and the integration begins anew.
  constexpr double kMostRatio = 2;
  const double ratio = last_h_s > 0 && h_s <= kMostRatio * last_h_s ? h_s / last_h_s : 0;
  const double h = ratio > 0 ? h_s * (1 + ratio) / (1 + 2 * ratio) : h_s;
  const double keep = 1 / (1 + damping_per_s * h);
  return {h, ratio * ratio / (1 + 2 * ratio), 1 - keep, keep};
}

namespace {

bool held(const Scene& scene) { return !scene.pins.vertices.empty() || !scene.grips.vertices.empty(); }

/// True if inextensible lines may be pulled apart at their two ends: by hands, or by pins too far apart. Pins that
/// leave tethers their reach do not.
bool may_be_pulled_apart(const Scene& scene) {
  if (scene.material.membrane_stiffness_N_per_m || wants_chains(scene) || !tethers_of(scene).to.empty()) return false;
  const std::vector<std::uint8_t> taut = taut_chains(scene);
  return std::any_of(taut.begin(), taut.end(), [](std::uint8_t t) { return t != 0; });
}

/// True unless a stretch wave crosses more than kMostOfCloth of an elastic cloth in a substep. Above, a horizontal
/// sheet let go of by two corners gains up to seven times the energy that it gains under backward Euler, and below less
/// (INTEGRATION.md has the table). Inextensible cloth stores no energy in its links.
bool resolves_waves(const Scene& scene, int substeps) {
  constexpr double kMostOfCloth = 0.6;
  double most = scene.material.membrane_stiffness_N_per_m.value_or(0), lightest = 1;
  for (const StiffnessRegion& r : scene.material.regions)
    most = std::max(most, r.membrane_stiffness_N_per_m.value_or(0));
  for (const double factor : scene.cloth.mass_factors) lightest = std::min(lightest, factor);
  const double h = scene.time.dt() / substeps,
               speed = std::sqrt(most / (lightest * scene.cloth.areal_density_kg_per_m2));
  return h * speed <= kMostOfCloth * std::max(scene.cloth.width_m, scene.cloth.height_m);
}

}  // namespace

Prediction prediction_of(const Scene& scene, const nlohmann::json& settings) {
  const std::string wanted = settings.value(kTuning, nlohmann::json::object()).value("prediction", "auto");
  if (settings.value("time_order", 1) < 2 && wanted != "always") return {false, "setting time_order=1"};
  const FeatureSet needs = scene.needs;
  if (!(needs & (kColliderFeatures | FeatureSet{Feature::SelfCollision})).empty())
    return {false, "the cloth touches: a contact would rebound"};
  if (wanted == "always") return {true, ""};
  if (starts_crumpled(scene)) return {false, "the cloth starts crumpled"};
  if (!held(scene)) return {true, ""};
  const int substeps = xpbd_substeps(scene, settings);
  if (may_be_pulled_apart(scene))
    return {false, "inextensible lines may be pulled apart at both ends, and would be thrown farther"};
  // A strip's links are one system and solved exactly; what a sheet's families leave to one another is not.
  if (!needs.has(Feature::Shear) && !needs.has(Feature::ClothMesh)) return {true, ""};
  if (!resolves_waves(scene, substeps))
    return {false, "a wave crosses the cloth in too few substeps: stiff links would gain energy"};
  if (!is_tethered(scene, settings) && substeps < std::lround(links_of_longer_side(scene.cloth) / 3))
    return {false, "no tethers and fewer substeps than a third of the links: the cloth would be thrown"};
  return {true, ""};
}

}  // namespace clothbench::pbd_gpu
