#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "clothbench/solver.hpp"
#include "xpbd/mesh/edge_paths.hpp"
#include "xpbd/mesh/matrices.hpp"
#include "xpbd/time/integrator.hpp"
#include "xpbd/time/rules.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Links along the longer side; for a mesh, its width divided by its edge length.
double links_of_longer_side(const Cloth& c) {
  return c.mesh ? std::max(1.0, c.width_m / c.mesh->edge_m) : std::max(c.columns, c.rows) - 1;
}

std::size_t quality_of(const nlohmann::json& settings) {
  const std::string quality = settings.value("quality", "default");
  return quality == "fast" ? 0 : quality == "default" ? 1 : 2;
}

/// The first row of xpbd/time/README.md that applies. `touches`: with contact in this frame.
const LinkRule& link_rule(const Scene& scene, const nlohmann::json& settings, bool touches) {
  const bool touched = touches || !(scene.needs & FeatureSet{Feature::Pins, Feature::MovingPins}).empty();
  const bool driven = !(scene.needs & FeatureSet{Feature::Capsules, Feature::MovingMesh}).empty();
  const bool shears = scene.needs.has(Feature::Shear), grips = !scene.grips.vertices.empty();
  const bool waves =
      grips && scene.material.membrane_stiffness_N_per_m.has_value() && grip_strain(scene) <= rules::kMaxGripStrain;
  if (!touched) return rules::kNoContact;
  if (driven && needs_chain_solver(scene)) return rules::kKinematicContactChains;
  if (driven) return touches ? rules::kKinematicContact : rules::kReleased;
  if (is_tethered(scene, settings)) return rules::kTethered;
  if (touches && !grips && shears) return rules::kOnColliders;
  if (!shears) return waves ? rules::kPulledStrip : rules::kStrip;
  if (!grips) return rules::kPinnedSheet;
  return grip_strain(scene) > rules::kMaxGripStrain ? rules::kPulledSheet : rules::kAttachedSheet;
}

/// True for a sheet that nothing but static colliders or itself touches or holds.
bool is_on_colliders(const Scene& scene, const nlohmann::json& settings) {
  return !is_contact_free(scene) && &link_rule(scene, settings, true) == &rules::kOnColliders;
}

double substeps_of(const LinkRule& rule, const Scene& scene, std::size_t quality) {
  return std::max(rule.smallest[quality], links_of_longer_side(scene.cloth) / rule.links_a_substep[quality]);
}

/// Maximum number of substeps that fast motion in contact may cause.
double max_for_speed(const Scene& scene, const nlohmann::json& settings) {
  const std::size_t quality = quality_of(settings);
  return is_on_colliders(scene, settings) ? substeps_of(rules::kImpact, scene, quality)
                                          : rules::kImpact.smallest[quality];
}

/// Maximum speed of colliders; for a user's hand, at least an assumed speed.
double speed_m_per_s(const Scene& scene) {
  const bool by_user =
      std::any_of(scene.colliders.begin(), scene.colliders.end(), [](const Collider& c) { return c.recorded; });
  return std::max(scripted_collider_speed_m_per_s(scene), by_user ? rules::kUsersHand_m_per_s : 0.0);
}

/// Substeps that fast motion in contact needs, without a maximum.
double wanted_for_speed(const Scene& scene, const nlohmann::json& settings) {
  const double speed =
      std::max(speed_m_per_s(scene) + norm(scene.cloth.initial_velocity_m_per_s), impact_speed_m_per_s(scene));
  double travel_m = std::numeric_limits<double>::infinity();
  for (const Collider& shape : scene.colliders)
    travel_m = std::min(travel_m, rules::kTravelMargins[quality_of(settings)] * shape.margin_m);
  return std::max(1.0, std::ceil(speed * scene.time.dt() / travel_m - 1e-9));
}

/// Substeps that limit the approach of two layers. Assumed speed: the sum of the initial speed, the speed of a fall by
/// the cloth's length and the speed of the fastest attachment or collider.
double substeps_for_layers(const Scene& scene) {
  const Cloth& c = scene.cloth;
  const double longer = std::max(c.width_m, c.height_m);
  const double speed = norm(c.initial_velocity_m_per_s) + norm(c.spin_rad_per_s) * longer +
                       std::sqrt(2 * norm(scene.gravity_m_per_s2) * longer) +
                       std::max(grip_speed_m_per_s(scene), speed_m_per_s(scene));
  return std::ceil(speed * scene.time.dt() / (rules::kMaxLayerApproach * c.self_collision.thickness_m) - 1e-9);
}

/// The motion for which substeps must suffice: slow motion on colliders; any motion, by the table; the scene's fastest.
enum class Motion { Slow, Any, Fastest };

/// Substeps by the rules of xpbd/time/README.md. `touches`: with contact in this frame.
int substeps_by_rules(const Scene& scene, const nlohmann::json& settings, bool touches, Motion motion) {
  if (const int given = settings.value("substeps", 0); given > 0) return given;
  const double links = links_of_longer_side(scene.cloth);
  const std::size_t k = quality_of(settings);
  const LinkRule& rule = link_rule(scene, settings, touches);
  const bool driven = !(scene.needs & FeatureSet{Feature::Capsules, Feature::MovingMesh}).empty();
  const bool shears = scene.needs.has(Feature::Shear), laid = touches && scene.grips.vertices.empty();
  const bool slow = motion == Motion::Slow && &rule == &rules::kOnColliders, fast = motion == Motion::Fastest;
  double per_frame = substeps_of(slow ? rules::kSlowOnColliders : rule, scene, k);
  if (needs_chain_solver(scene)) per_frame *= substeps_for_short_links(scene);
  const double longer_m = std::max(scene.cloth.width_m, scene.cloth.height_m),
               swing = scene.time.dt() * std::sqrt(norm(scene.gravity_m_per_s2) / longer_m);
  if (swing > rules::kMaxSwing && ((is_held(scene) && is_contact_free(scene)) || (laid && !driven && shears)))
    per_frame *= swing / rules::kMaxSwing;
  if (laid && !driven && !shears && !is_tethered(scene, settings))
    per_frame = std::max(per_frame, std::ceil(swing / rules::kMaxSlidingStep[k] - 1e-9));
  if (scene.needs.has(Feature::SelfCollision) && laid) per_frame *= rules::kLayersFactor;
  if (scene.needs.has(Feature::SelfCollision) && fast) per_frame = std::max(per_frame, substeps_for_layers(scene));
  if (may_correct_splitting(scene, settings).enabled)
    if (const double needed = std::ceil(substeps_for_splitting(scene));
        needed <= std::max(rules::kMaxSplittingSubsteps[k], links / 6))
      per_frame = std::max(per_frame, needed);
  const double for_speed = fast ? std::min(max_for_speed(scene, settings), wanted_for_speed(scene, settings)) : 1;
  const auto n = std::clamp(std::max(std::lround(per_frame), std::lround(for_speed)), 1L, 4096L);
  return touches ? static_cast<int>(n) : substeps_for_membrane(scene, static_cast<int>(n));
}

}  // namespace

int xpbd_substeps(const Scene& scene, const nlohmann::json& settings) {
  return substeps_by_rules(scene, settings, !is_contact_free(scene), Motion::Fastest);
}

int uncapped_substeps_if_capped(const Scene& scene, const nlohmann::json& settings) {
  if (settings.value("substeps", 0) > 0 || is_contact_free(scene)) return 0;
  const double wanted = wanted_for_speed(scene, settings);
  return wanted > xpbd_substeps(scene, settings) ? static_cast<int>(std::min(wanted, 1e6)) : 0;
}

int contact_free_substeps(const Scene& scene, const nlohmann::json& settings) {
  return std::min(xpbd_substeps(scene, settings), substeps_by_rules(scene, settings, false, Motion::Any));
}

SubstepController::SubstepController(const Scene& scene, const nlohmann::json& settings, bool adapts)
    : max_strain_(rules::kMaxStrain[quality_of(settings)]),
      repeat_strain_(rules::kRepeatStrain[quality_of(settings)]),
      adapts_(adapts),
      is_driven_(scene.needs.has(Feature::MovingMesh)),
      is_strip_(adapts && !is_driven_ && !scene.needs.has(Feature::Shear)),
      cell_m_(scene.cloth.mesh ? scene.cloth.mesh->edge_m : std::max(scene.cloth.du(), scene.cloth.dv())) {
  const bool varies = adapts && !is_strip_, touches = !is_contact_free(scene);
  // A hand's speed is known beforehand, so all frames have the number for it.
  const auto number = [&](Motion motion) {
    return substeps_by_rules(scene, settings, touches, is_driven_ ? Motion::Fastest : motion);
  };
  max_ = xpbd_substeps(scene, settings);
  if (varies) max_ = std::max(max_, static_cast<int>(std::lround(max_for_speed(scene, settings))));
  base_ = std::min(max_, number(Motion::Any));
  slow_ = varies ? std::min(base_, number(Motion::Slow)) : max_;
  reset();
}

void SubstepController::reset() {
  now_ = is_strip_ ? rules::kStartFactor * max_ : slow_;
  lists_ = 1;
  strained_ = slow_;
  tolerated_ = repeat_strain_;
  attempt_strain_ = std::numeric_limits<double>::infinity();
  halvings_ = quiescent_frames_ = 0;
}

void SubstepController::next(double cloth_m, double strain) {
  if (is_strip_) {
    if (!std::isinf(cloth_m)) now_ = max_;
    return;
  }
  if (!is_driven_) halve_if_quiescent(cloth_m);
  if (!(strain <= max_strain_))
    strained_ = std::min(base_, 3 * std::max(strained_, now_) / 2);
  else if (strain <= rules::kFewerBelow * max_strain_)
    strained_ = std::max(slow_, 3 * strained_ / 4);
  now_ = std::min(strained_, (base_ + (1 << halvings_) - 1) >> halvings_);
  attempt_strain_ = std::numeric_limits<double>::infinity();
  const int most = std::max(1, now_ / rules::kMinSubstepsPerList);
  const double lists = std::ceil(cloth_m / cell_m_ / rules::kCellsPerList);
  lists_ = lists < most ? std::max(1, static_cast<int>(lists)) : most;  // also if cloth_m is NaN
}

bool SubstepController::repeats(double strain) {
  if (!adapts_ || is_strip_) return false;
  if (strain <= repeat_strain_) tolerated_ = repeat_strain_;
  const double before = std::exchange(attempt_strain_, strain);
  if (strain <= tolerated_) return false;
  if (now_ >= max_ || strain > rules::kWorthRepeating * before) {
    tolerated_ = std::fmax(repeat_strain_, rules::kToleratedGrowth * strain);  // also if strain is NaN
    return false;
  }
  now_ = std::min(2 * now_, max_);
  return true;
}

/// Cloth at rest uses at most half of base_, and later a quarter, until it moves.
void SubstepController::halve_if_quiescent(double cloth_m) {
  const double cells = cloth_m / cell_m_;
  quiescent_frames_ = cells <= rules::kQuiescent ? quiescent_frames_ + 1 : 0;
  if (!(cells <= rules::kMoves))
    halvings_ = 0;
  else if (quiescent_frames_ == rules::kQuiescentFrames) {
    halvings_ = std::min(halvings_ + 1, rules::kMaxHalvings);
    quiescent_frames_ = 0;
  }
}

}  // namespace clothbench::pbd_gpu
