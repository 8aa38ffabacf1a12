#include "xpbd/time/substep_count.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "clothbench/motion.hpp"
#include "clothbench/solver.hpp"
#include "xpbd/lines/line_layout.hpp"
#include "xpbd/mesh/edge_paths.hpp"
#include "xpbd/time/integrator.hpp"

namespace clothbench::pbd_gpu {
namespace {

int quality_of(const nlohmann::json& settings) {
  const std::string quality = settings.value("quality", "default");
  return quality == "fast" ? 0 : quality == "default" ? 1 : 2;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// How far a moving collider, or a cloth that falls or is thrown on static shapes, may go in a substep, by quality: so
/// many margins. A struck vertex then pulls its neighbours along before the links between are overstretched. On what
/// stands much of the cloth is struck at once, so that the way is also at most so many quarters of a cell. At default
/// what is fast goes half as far, for strain grows with speed.
constexpr double kMargins[] = {2, 1, 0.5}, kFasterOnImpact[] = {1, 2, 1};

/// Layers that approach by more than this fraction of their thickness in a substep cannot be parted by responses, and
/// planes cut the ways of vertices (xpbd/contact/README.md, "The cloth with itself").
constexpr double kMaxLayerApproach = 2.0 / 3;

TravelLimit travel_limit(const Scene& scene, int quality) {
  constexpr double kMin = 0.125, kMaxOnImpact = 0.25;  // of a cell
  const double cell = std::min(scene.cloth.du(), scene.cloth.dv());
  double margin = kInfinity;
  for (const Collider& c : scene.colliders) margin = std::min(margin, std::max(c.margin_m, kMin * cell));
  const bool impact = impact_speed_m_per_s(scene) > 0;
  if (impact) margin = std::min(margin, kMaxOnImpact * cell);
  TravelLimit rule{kMargins[quality] * margin, impact ? kFasterOnImpact[quality] : 1, kInfinity};
  // Two layers may come towards each other.
  if (scene.needs.has(Feature::SelfCollision))
    rule.layers_m = kMaxLayerApproach / 2 * scene.cloth.self_collision.thickness_m;
  return rule;
}

/// Speed of colliders. The motion of a user's hand is not known when a live session begins, and its replay must take as
/// many substeps, so the hand counts as fast as hands usually are.
double speed_m_per_s(const Scene& scene) {
  constexpr double kUsersHand_m_per_s = 2;
  const bool by_user =
      std::any_of(scene.colliders.begin(), scene.colliders.end(), [](const Collider& c) { return c.recorded; });
  return std::max(scripted_collider_speed_m_per_s(scene), by_user ? kUsersHand_m_per_s : 0);
}

double substeps_by_margins(const Scene& scene, int quality) {
  const double speed = speed_m_per_s(scene) + norm(scene.cloth.initial_velocity_m_per_s);
  TravelLimit rule = travel_limit(scene, quality);
  rule.layers_m = kInfinity;
  return std::max(1.0, rule.wanted(std::max(speed, impact_speed_m_per_s(scene)) * scene.time.dt()));
}

/// Nothing is passed with any number (xpbd/contact/README.md), so that this is a matter of quality, and may be capped
/// by what a frame may cost.
constexpr double kBudget[] = {16, 32, 64}, kBudgetOnImpact[] = {32, 96, 96};
double budget_of(const Scene& scene, int quality) {
  return (impact_speed_m_per_s(scene) > 0 ? kBudgetOnImpact : kBudget)[quality];
}

double substeps_for_speed(const Scene& scene, int quality) {
  return std::min(budget_of(scene, quality), substeps_by_margins(scene, quality));
}

/// A strip that slides over colliders is integrated at first order, and its error goes by h sqrt(g / L): up to this it
/// is within 3 % (Atwood's rope on a cylinder).
double substeps_for_sliding_strip(const Scene& scene, int quality) {
  constexpr double kMaxStep[] = {0.005, 0.0025, 0.00125};
  const double longer = std::max(scene.cloth.width_m, scene.cloth.height_m);
  return std::ceil(scene.time.dt() * std::sqrt(norm(scene.gravity_m_per_s2) / longer) / kMaxStep[quality] - 1e-9);
}

/// A frame in which gravity takes the cloth far stands for several: what it swings through in a substep grows with
/// dt sqrt(g / L), so that above kMax of it substeps grow with the square root of gravity.
double frames_for_gravity(const Scene& scene) {
  constexpr double kMax = 0.15;
  const double longer = std::max(scene.cloth.width_m, scene.cloth.height_m);
  const double swing = scene.time.dt() * std::sqrt(norm(scene.gravity_m_per_s2) / longer);
  return swing > kMax && is_held(scene) && is_contact_free(scene) ? swing / kMax : 1;
}

/// Maximum number of substeps that a sheet takes so that its modulus is Y. At `fast` it may stay below.
double max_substeps_for_splitting(double links, int quality) {
  constexpr double kMax[] = {6, 32, 64};
  return std::max(kMax[quality], links / 6);
}

/// The assumed speed is the sum of the scene's initial speed, the speed of a fall by the cloth's length, and the speed
/// of the fastest grip or collider.
double substeps_for_layers(const Scene& scene) {
  const Cloth& c = scene.cloth;
  const double longer = std::max(c.width_m, c.height_m);
  const double speed = norm(c.initial_velocity_m_per_s) + norm(c.spin_rad_per_s) * longer +
                       std::sqrt(2 * norm(scene.gravity_m_per_s2) * longer) +
                       std::max(grip_speed_m_per_s(scene), speed_m_per_s(scene));
  return std::ceil(speed * scene.time.dt() / (kMaxLayerApproach * c.self_collision.thickness_m) - 1e-9);
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

/// By the rules of README, "Substeps"; `touches`: what touches the cloth in the frame needs its share; `fast`: for
/// its speed too.
int substeps_by_rules(const Scene& scene, const nlohmann::json& settings, bool touches, bool fast) {
  if (const int given = settings.value("substeps", 0); given > 0) return given;
  const double links = links_of_longer_side(scene.cloth);
  struct Rule {
    double smallest, links_a_substep;
  };
  const int k = quality_of(settings);
  const bool touched = touches || !(scene.needs & FeatureSet{Feature::Pins, Feature::MovingPins}).empty();
  const bool tethered = is_tethered(scene, settings);
  const auto Y = scene.material.membrane_stiffness_N_per_m;
  const bool stiff = !Y || *Y >= 1e4;
  // Substeps are counted per frame, whatever its duration: a constant in seconds would differ between scaled copies of
  // a scene. A link must not turn by more than about half a radian per substep.
  constexpr Rule kStiff[] = {{2, 24}, {6, 12}, {20, 6}}, kTethered[] = {{3, 24}, {5, 12}, {20, 6}},
                 kStrips[] = {{5, 12}, {10, 6}, {20, 3}}, kSheet[] = {{5, 6}, {10, 3}, {20, 1.5}},
                 kKinematicContact[] = {{4, 8}, {5, 6}, {20, 1.5}}, kReleased[] = {{4, 8}, {5, 8}, {20, 6}},
                 kKinematicContactChains[] = {{5, 6}, {8, 4}, {20, 1.5}},
                 kRestingOnStatic[] = {{8, 4}, {16, 2}, {32, 1}}, kRestingStrips[] = {{8, 12}, {14, 6}, {28, 3}},
                 kStretchedByAttachments[] = {{10, 6}, {20, 3}, {40, 1.5}},
                 kNoContact[] = {{3, 1e9}, {5, 1e9}, {20, 1e9}};
  // A heap of the cloth's own layers slides on for long with as few as one layer takes.
  constexpr double kLayers = 1.5;
  const auto& grips = scene.grips.vertices;
  // A hand pushes a cloth in directions that tethers do not limit.
  const bool driven = !(scene.needs & FeatureSet{Feature::Capsules, Feature::MovingMesh}).empty();
  const bool shears = scene.needs.has(Feature::Shear), laid = touches && grips.empty();
  const Rule rule = !touched        ? kNoContact[k]
                    : driven        ? (needs_chain_solver(scene) ? kKinematicContactChains
                                       : touches                 ? kKinematicContact
                                                                 : kReleased)[k]
                    : tethered      ? (stiff ? kStiff[k] : kTethered[k])
                    : laid          ? (shears ? kRestingOnStatic[k] : kRestingStrips[k])
                    : !shears       ? kStrips[k]
                    : grips.empty() ? kSheet[k]
                                    : kStretchedByAttachments[k];
  // With few substeps the error is largest in the links at the pins, which carry more the finer the cloth is.
  const double fine = k == 0 && rule.links_a_substep == kStiff[0].links_a_substep && links > 300 ? 1.2 : 1;
  const double short_links = needs_chain_solver(scene) ? substeps_for_short_links(scene) : 1;
  double per_frame =
      short_links * frames_for_gravity(scene) * std::max(rule.smallest, fine * links / rule.links_a_substep);
  if (laid && !driven && !shears && !tethered) per_frame = std::max(per_frame, substeps_for_sliding_strip(scene, k));
  if (scene.needs.has(Feature::SelfCollision) && laid) per_frame *= kLayers;
  if (scene.needs.has(Feature::SelfCollision) && fast) per_frame = std::max(per_frame, substeps_for_layers(scene));
  if (may_correct_splitting(scene, settings).enabled)
    if (const double needed = std::ceil(substeps_for_splitting(scene)); needed <= max_substeps_for_splitting(links, k))
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
  // From eight of the ways a substep on what moves farther counts as faster, from 8 `faster` of them on it is.
  constexpr double kFast = 8;
  const double vertex_displacement = max_displacement_m / travel_m;
  return std::ceil(std::max(vertex_displacement * std::clamp(vertex_displacement / kFast, 1.0, faster),
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
  // Strain of an impact relaxes in the frames after it.
  constexpr double kLess = 0.75;
  const double wanted = std::max(rule_.wanted(cloth_m), before > base_ ? kLess * before : 0.0);
  // By fours, so that a frame is not recorded anew each time.
  now_ = wanted < max_ ? std::clamp(static_cast<int>(4 * std::ceil(wanted / 4)), smallest, max_) : max_;
  if (wanted <= base_) now_ = smallest;
}

/// Cloth that lies takes half of the base, and later a quarter: after some frames in which no vertex went farther than
/// a twenty-fourth of a cell. All of it comes back once one goes a sixth, for fewer substeps leave more strain, so that
/// the cloth gives a little when they change.
void SubstepController::halve_if_quiescent(double cloth_m) {
  constexpr int kQuiescentFrames = 4, kMax = 2;
  const double cells = cloth_m / cell_m_;
  quiescent_frames_ = cells <= 1 / 24.0 ? quiescent_frames_ + 1 : 0;
  if (!(cells <= 1 / 6.0))
    halvings_ = 0;
  else if (quiescent_frames_ == kQuiescentFrames) {
    halvings_ = std::min(halvings_ + 1, kMax);
    quiescent_frames_ = 0;
  }
}

}  // namespace clothbench::pbd_gpu
