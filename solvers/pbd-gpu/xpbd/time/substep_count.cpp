#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "clothbench/motion.hpp"
#include "clothbench/solver.hpp"
#include "xpbd/lines/line_layout.hpp"
#include "xpbd/mesh/edge_paths.hpp"
#include "xpbd/time/integrator.hpp"
#include "xpbd/time/rules.hpp"

namespace clothbench::pbd_gpu {
namespace {

std::size_t quality_of(const nlohmann::json& settings) {
  const std::string quality = settings.value("quality", "default");
  return quality == "fast" ? 0 : quality == "default" ? 1 : 2;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// How far a moving collider, or a cloth that falls or is thrown on static shapes, may go in a substep.
TravelLimit travel_limit(const Scene& scene, std::size_t quality) {
  const double cell = std::min(scene.cloth.du(), scene.cloth.dv());
  double margin = kInfinity;
  for (const Collider& c : scene.colliders)
    margin = std::min(margin, std::max(c.margin_m, rules::kMinMarginOfCell * cell));
  const bool impact = impact_speed_m_per_s(scene) > 0;
  if (impact) margin = std::min(margin, rules::kMaxTravelOnImpact * cell);
  TravelLimit rule{rules::kTravelMargins[quality] * margin, impact ? rules::kFasterOnImpact[quality] : 1, kInfinity};
  // Two layers may come towards each other.
  if (scene.needs.has(Feature::SelfCollision))
    rule.layers_m = rules::kMaxLayerApproach / 2 * scene.cloth.self_collision.thickness_m;
  return rule;
}

/// Speed of colliders; a user's hand counts as fast as hands usually are.
double speed_m_per_s(const Scene& scene) {
  const bool by_user =
      std::any_of(scene.colliders.begin(), scene.colliders.end(), [](const Collider& c) { return c.recorded; });
  return std::max(scripted_collider_speed_m_per_s(scene), by_user ? rules::kUsersHand_m_per_s : 0.0);
}

double substeps_by_margins(const Scene& scene, std::size_t quality) {
  const double speed = speed_m_per_s(scene) + norm(scene.cloth.initial_velocity_m_per_s);
  TravelLimit rule = travel_limit(scene, quality);
  rule.layers_m = kInfinity;
  return std::max(1.0, rule.wanted(std::max(speed, impact_speed_m_per_s(scene)) * scene.time.dt()));
}

double substeps_for_speed(const Scene& scene, std::size_t quality) {
  const auto& most = impact_speed_m_per_s(scene) > 0 ? rules::kMaxForImpact : rules::kMaxForSpeed;
  return std::min(most[quality], substeps_by_margins(scene, quality));
}

double substeps_for_sliding_strip(const Scene& scene, std::size_t quality) {
  const double longer = std::max(scene.cloth.width_m, scene.cloth.height_m);
  return std::ceil(
      scene.time.dt() * std::sqrt(norm(scene.gravity_m_per_s2) / longer) / rules::kMaxSlidingStep[quality] - 1e-9);
}

/// Frames that a frame in which gravity takes the cloth far stands for: substeps grow with the square root of gravity.
double frames_for_gravity(const Scene& scene) {
  const double longer = std::max(scene.cloth.width_m, scene.cloth.height_m);
  const double swing = scene.time.dt() * std::sqrt(norm(scene.gravity_m_per_s2) / longer);
  return swing > rules::kMaxSwing && is_held(scene) && is_contact_free(scene) ? swing / rules::kMaxSwing : 1;
}

/// The assumed speed is the sum of the scene's initial speed, the speed of a fall by the cloth's length, and the speed
/// of the fastest grip or collider.
double substeps_for_layers(const Scene& scene) {
  const Cloth& c = scene.cloth;
  const double longer = std::max(c.width_m, c.height_m);
  const double speed = norm(c.initial_velocity_m_per_s) + norm(c.spin_rad_per_s) * longer +
                       std::sqrt(2 * norm(scene.gravity_m_per_s2) * longer) +
                       std::max(grip_speed_m_per_s(scene), speed_m_per_s(scene));
  return std::ceil(speed * scene.time.dt() / (rules::kMaxLayerApproach * c.self_collision.thickness_m) - 1e-9);
}

}  // namespace

int uncapped_substeps_if_capped(const Scene& scene, const nlohmann::json& settings) {
  if (settings.value("substeps", 0) > 0 || is_contact_free(scene)) return 0;
  const double wanted = substeps_by_margins(scene, quality_of(settings));
  return wanted > xpbd_substeps(scene, settings) ? static_cast<int>(std::min(wanted, 1e6)) : 0;
}

double links_of_longer_side(const Cloth& c) {
  return c.mesh ? std::max(1.0, c.width_m / c.mesh->edge_m) : std::max(c.columns, c.rows) - 1;
}

namespace {

/// By the page of this folder, "Substeps". `touches`: for what touches the cloth in the frame; `fast`: for its speed.
int substeps_by_rules(const Scene& scene, const nlohmann::json& settings, bool touches, bool fast) {
  if (const int given = settings.value("substeps", 0); given > 0) return given;
  const double links = links_of_longer_side(scene.cloth);
  const std::size_t k = quality_of(settings);
  const bool touched = touches || !(scene.needs & FeatureSet{Feature::Pins, Feature::MovingPins}).empty();
  const bool tethered = is_tethered(scene, settings);
  const auto Y = scene.material.membrane_stiffness_N_per_m;
  const bool stiff = !Y || *Y >= rules::kStiff;
  const auto& grips = scene.grips.vertices;
  // A hand pushes a cloth in directions that tethers do not limit.
  const bool driven = !(scene.needs & FeatureSet{Feature::Capsules, Feature::MovingMesh}).empty();
  const bool shears = scene.needs.has(Feature::Shear), laid = touches && grips.empty();
  // The first that applies.
  const LinkRule& rule = !touched        ? rules::kNoContact
                         : driven        ? (needs_chain_solver(scene) ? rules::kKinematicContactChains
                                            : touches                 ? rules::kKinematicContact
                                                                      : rules::kReleased)
                         : tethered      ? (stiff ? rules::kTetheredStiff : rules::kTethered)
                         : laid          ? (shears ? rules::kResting : rules::kRestingStrip)
                         : !shears       ? rules::kStrip
                         : grips.empty() ? rules::kPinnedSheet
                                         : rules::kAttachedSheet;
  const double links_a_substep = rule.links_a_substep[k];
  // With few substeps the error is largest in the links at the pins, which carry more the finer the cloth is.
  const bool fine = k == 0 && links_a_substep == rules::kTetheredStiff.links_a_substep[0] && links > rules::kManyLinks;
  const double short_links = needs_chain_solver(scene) ? substeps_for_short_links(scene) : 1;
  double per_frame = short_links * frames_for_gravity(scene) *
                     std::max(rule.smallest[k], (fine ? rules::kManyLinksFactor : 1.0) * links / links_a_substep);
  if (laid && !driven && !shears && !tethered) per_frame = std::max(per_frame, substeps_for_sliding_strip(scene, k));
  if (scene.needs.has(Feature::SelfCollision) && laid) per_frame *= rules::kLayersFactor;
  if (scene.needs.has(Feature::SelfCollision) && fast) per_frame = std::max(per_frame, substeps_for_layers(scene));
  if (may_correct_splitting(scene, settings).enabled)
    if (const double needed = std::ceil(substeps_for_splitting(scene));
        needed <= std::max(rules::kMaxSplittingSubsteps[k], links / 6))
      per_frame = std::max(per_frame, needed);
  const double for_speed = fast ? substeps_for_speed(scene, k) : 1;
  return static_cast<int>(std::clamp(std::max(std::lround(per_frame), std::lround(for_speed)), 1L, 4096L));
}

}  // namespace

int xpbd_substeps(const Scene& scene, const nlohmann::json& settings) {
  return substeps_by_rules(scene, settings, !is_contact_free(scene), true);
}

int contact_free_substeps(const Scene& scene, const nlohmann::json& settings) {
  return std::min(xpbd_substeps(scene, settings), substeps_by_rules(scene, settings, false, false));
}

double TravelLimit::wanted(double max_displacement_m) const {
  const double vertex_displacement = max_displacement_m / travel_m;
  return std::ceil(std::max(vertex_displacement * std::clamp(vertex_displacement / rules::kFastTravel, 1.0, faster),
                            max_displacement_m / layers_m) -
                   1e-9);
}

SubstepController::SubstepController(const Scene& scene, const nlohmann::json& settings, bool adapts)
    : rule_(travel_limit(scene, quality_of(settings))), adapts_(adapts) {
  max_ = xpbd_substeps(scene, settings);
  base_ = std::min(max_, substeps_by_rules(scene, settings, !is_contact_free(scene), false));
  const Cloth& cloth = scene.cloth;
  cell_m_ = cloth.mesh ? cloth.mesh->edge_m : std::max(cloth.du(), cloth.dv());
  reset();
}

void SubstepController::reset() {
  now_ = max_;
  halvings_ = quiescent_frames_ = 0;
}

void SubstepController::next(double cloth_m) {
  const int before = now_;
  halve_if_quiescent(cloth_m);
  const int smallest = std::max(1, (base_ + (1 << halvings_) - 1) >> halvings_);
  const double wanted = std::max(rule_.wanted(cloth_m), before > base_ ? rules::kMinOfLast * before : 0.0);
  constexpr double kGrain = rules::kSubstepGrain;
  now_ = wanted < max_ ? std::clamp(static_cast<int>(kGrain * std::ceil(wanted / kGrain)), smallest, max_) : max_;
  if (wanted <= base_) now_ = smallest;
}

/// Cloth that lies takes half of the base, and later a quarter: after some frames in which no vertex went farther than
/// a twenty-fourth of a cell. All of it comes back once one goes a sixth, for fewer substeps leave more strain, so that
/// the cloth gives a little when they change.
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
