#include "xpbd/contact/contact.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace clothbench::pbd_gpu {

/// Default capacity of the list of candidate pairs: per primitive, minimum and maximum; at most all pairs. Crumpled
/// cloths and desks use a third of it. The minimum is all pairs of a small scene, where boxes of long oblique triangles
/// overlap much of the cloth. If the list overflows, the motion bounds of the vertices are reduced.
constexpr std::uint32_t kPairsPerPrimitive = 64, kMinPairs = 1u << 18, kMaxPairs = 1u << 20;
/// Capacities of self-contact: candidate pairs, active pairs, pairs with contacts. Ten layers on a ball
/// (contact/layers) need less than half of the last two.
constexpr std::uint32_t kPairsPerTriangle = 96, kMaxSelfPairs = 1u << 24, kActivePerTriangle = 80,
                        kMaxActive = 1u << 22, kContactPairsPerTriangle = 16, kMinContactPairs = 1u << 15;
/// Threads of a pass over pairs; over all candidates (128 x 128 vertices on a sphere take 7 % less time than with
/// kPairThreads, H200); on a software device.
constexpr std::uint32_t kPairThreads = 1u << 14, kCandidateThreads = 1u << 16, kSoftwareThreads = 1u << 9;
/// Maximum lanes per vertex: kPartialSums of contact_accumulate.glsl.
constexpr std::uint32_t kMaxLanesPerVertex = 8;
/// Lengths of the displacement filter, relative to the scene's, so that scaled copies of a scene move alike: distance
/// of planes from shapes and layers, and rounding error of positions in float32.
constexpr double kSeparationOfMargin = 0.05, kSeparationOfThickness = 0.1, kRoundingOfMargin = 5e-5,
                 kRoundingOfSide = 1e-7, kInfinity = std::numeric_limits<double>::infinity();
/// Response rounds after the constraint solve: on static shapes only, and otherwise. With one round, layers that lie on
/// one another stay strained, and slide.
constexpr std::uint32_t kRoundsOnStatic = 1, kRounds = 2;

XpbdContact::XpbdContact(FrameBuilder& frame, const Scene& scene, Vec3 origin_m, const ColliderBuffers* colliders,
                         const std::vector<std::uint32_t>& particle, bool second_solve, std::uint32_t growth)
    : frame_(frame), scene_(scene), with_itself_(scene.needs.has(Feature::SelfCollision)) {
  const ConvexShapes all = convex_shapes(scene, origin_m, colliders);
  frame_.set_contact_margins(all.margins_m);
  kinematic_points_ = static_cast<std::uint32_t>(all.sources.size());
  constants_.SHAPES = static_cast<uint>(all.shapes.size());
  constants_.GROUPS = static_cast<uint>(all.boxes.size() - all.shapes.size());
  if (constants_.SHAPES > 0) {
    frame_.add_buffer(BIND_SHAPES, "contact convex shapes", all.shapes);
    frame_.add_buffer(BIND_POINTS, "contact points", all.points);
    frame_.add_buffer(BIND_SHAPE_AABBS, "contact convex shape boxes", all.boxes);
  }
  if (kinematic_points_ > 0) frame_.add_buffer(BIND_POINT_SOURCES, "contact point sources", all.sources);
  constants_.ROUNDS = with_itself_ || second_solve || kinematic_points_ > 0 ? kRounds : kRoundsOnStatic;
  constants_.PLANES = colliders != nullptr ? colliders->planes.count : 0;
  constants_.MAX_POINTS = all.max_points;
  constants_.HAS_KINEMATIC = kinematic_points_ > 0 ? 1 : 0;
  constants_.LANES_PER_VERTEX = std::bit_floor(std::clamp(frame_.device()->shuffled_lanes(), 1u, kMaxLanesPerVertex));
  constants_.VERTICES = static_cast<uint>(scene_.cloth.vertex_count());
  set_lengths(all);
  pass_constants_.GRIPS = static_cast<uint>(scene_.grips.vertices.size());
  pass_constants_.SECOND_SOLVE = second_solve ? 1 : 0;
  add_primitives(particle);
  if (with_itself_) add_self_pairs(particle, growth);
  if (kinematic_points_ == 0) return;
  stage_pairs_ = frame_.add_stage("ContactBroadPhase", serves());
  update_shapes_ = {pass(stage_pairs_, "contact_update_shapes", std::uint64_t{kGroupSize} * constants_.GROUPS)};
}

void XpbdContact::set_lengths(const ConvexShapes& all) {
  const auto bits = [](double x_m) { return std::bit_cast<uint>(static_cast<float>(x_m)); };
  const double thickness_m = with_itself_ ? scene_.cloth.self_collision.thickness_m : kInfinity,
               margin_m = all.margins_m.empty() ? thickness_m : *std::ranges::min_element(all.margins_m),
               longer_m = std::max(scene_.cloth.width_m, scene_.cloth.height_m);
  constants_.MARGIN_BITS = bits(std::max(all.max_margin_m, with_itself_ ? 0.5 * thickness_m : 0));
  constants_.MIN_SEPARATION_BITS = bits(std::min(kSeparationOfMargin * margin_m, kSeparationOfThickness * thickness_m));
  constants_.ROUNDING_BITS = bits(std::max(kRoundingOfMargin * margin_m, kRoundingOfSide * longer_m));
}

void XpbdContact::add_primitives(const std::vector<std::uint32_t>& particle) {
  const std::uint32_t n = constants_.VERTICES;
  const auto of = [&](std::uint32_t v) { return particle.empty() ? v : particle[v]; };
  std::vector<uvec4> primitives;
  std::vector<std::vector<std::uint32_t>> vertex_triangles(n);
  for (const auto& t : triangles(scene_.cloth)) {
    const auto number = static_cast<std::uint32_t>(primitives.size());
    primitives.push_back({of(t[0]), of(t[1]), of(t[2]), 3});
    for (std::uint32_t corner = 0; corner < 3; ++corner) vertex_triangles[of(t[corner])].push_back(4 * number + corner);
  }
  constants_.TRIANGLES = static_cast<std::uint32_t>(primitives.size());
  for (std::uint32_t v = 0; v < n; ++v) primitives.push_back({v, v, v, 1});
  std::vector<std::uint32_t> all;
  auto first = n + 1;
  for (const auto& fan : vertex_triangles) {
    all.push_back(first);
    first += static_cast<std::uint32_t>(fan.size());
  }
  all.push_back(first);
  for (const auto& fan : vertex_triangles) all.insert(all.end(), fan.begin(), fan.end());
  const auto count = static_cast<std::uint32_t>(primitives.size());
  std::uint32_t& capacity = constants_.CAPACITY = frame_.tuning()["contact_pairs"].get<std::uint32_t>();
  const std::uint64_t all_pairs = std::uint64_t{count} * std::max(1U, constants_.SHAPES);
  if (capacity == 0)
    capacity = static_cast<std::uint32_t>(
        std::min<std::uint64_t>(std::clamp(kPairsPerPrimitive * count, kMinPairs, kMaxPairs), all_pairs));
  holds_all_pairs_ = capacity >= all_pairs;
  frame_.add_buffer(BIND_PRIMITIVES, "contact primitives", primitives);
  frame_.add_buffer(BIND_VERTEX_TRIANGLES, "contact vertex triangles", all);
  frame_.add_buffer(BIND_RANGES, "contact ranges", count * sizeof(uvec4));
  frame_.add_buffer(BIND_TOUCHED, "contact touched", 4 * std::uint64_t{n} * sizeof(uint));
  frame_.add_buffer(BIND_ACTIVE_BITS, "contact active pairs", 2 * std::uint64_t{capacity / 32 + 1} * sizeof(uint));
  frame_.add_buffer(BIND_PAIRS, "contact pairs", std::uint64_t{capacity} * sizeof(uvec4));
  frame_.add_buffer(BIND_PAIR_STATES, "contact pair states", std::uint64_t{capacity} * sizeof(PairState));
  ContactFrameState frame_state{};
  std::fill(std::begin(frame_state.cloth_low), std::end(frame_state.cloth_low), ~0u);
  frame_state_ = &frame_.add_buffer(BIND_FRAME_STATE, "contact frame state", std::vector{frame_state});
  frame_.add_buffer(BIND_PREDICTED, "contact predicted positions", n * sizeof(vec4));
  frame_.add_buffer(BIND_STARTS, "contact starts", n * sizeof(vec4));
  frame_.add_buffer(BIND_MOTION_BOUNDS, "contact motion bounds", n * sizeof(vec4));
  frame_.add_buffer(BIND_VERTEX_DISPLACEMENTS, "contact vertex displacements", n * sizeof(float));
  diagnostics_ = &frame_.add_host_buffer("contact diagnostics", sizeof(ContactDiagnostics), BIND_DIAGNOSTICS);
}

/// Adds the buffers of self-contact.
void XpbdContact::add_self_pairs(const std::vector<std::uint32_t>& particle, std::uint32_t growth) {
  const auto& self = scene_.cloth.self_collision;
  auto all = triangles(scene_.cloth);
  for (auto& t : all)
    for (auto& v : t) v = particle.empty() ? v : particle[v];
  // If tuning.contact_pairs is set, it is the capacity of the candidate pairs and of the active pairs.
  const std::uint32_t wanted = frame_.tuning()["contact_pairs"].get<std::uint32_t>();
  ContactPassSpecialization& c = pass_constants_;
  c.SELF = 1;
  c.SELF_CAPACITY = growth * (wanted != 0 ? wanted : std::min(kPairsPerTriangle * constants_.TRIANGLES, kMaxSelfPairs));
  c.ACTIVE_CAPACITY = growth * (wanted != 0 ? wanted : std::min(kActivePerTriangle * constants_.TRIANGLES, kMaxActive));
  c.CONTACT_CAPACITY =
      std::min(c.ACTIVE_CAPACITY, growth * std::max(kContactPairsPerTriangle * constants_.TRIANGLES, kMinContactPairs));
  c.THICKNESS_BITS = std::bit_cast<uint>(static_cast<float>(self.thickness_m));
  c.SELF_FRICTION_BITS = std::bit_cast<uint>(static_cast<float>(self.friction));
  const std::uint32_t groups = (constants_.TRIANGLES + TRIANGLES_PER_GROUP - 1) / TRIANGLES_PER_GROUP;
  const std::uint64_t active = c.ACTIVE_CAPACITY, touching = c.CONTACT_CAPACITY;
  frame_.add_buffer(BIND_SELF_ORDER, "self-contact order", cluster(initial_positions(scene_), all).triangles);
  frame_.add_buffer(BIND_SELF_AABBS, "self-contact boxes", (constants_.TRIANGLES + groups) * sizeof(SelfAabb));
  const SelfSupergroup none{{~0u, ~0u, ~0u}, {0, 0, 0}};
  frame_.add_buffer(BIND_SELF_SUPERGROUPS, "self-contact supergroups",
                    std::vector((groups + GROUPS_PER_SUPERGROUP - 1) / GROUPS_PER_SUPERGROUP, none));
  frame_.add_buffer(BIND_SELF_BOUNDS, "self-contact bounds", constants_.VERTICES * sizeof(SelfBounds));
  frame_.add_buffer(BIND_SELF_RANGES, "self-contact ranges", constants_.TRIANGLES * sizeof(uvec4));
  frame_.add_buffer(BIND_SELF_PAIRS, "self-contact pairs", std::uint64_t{c.SELF_CAPACITY} * sizeof(SelfPair));
  frame_.add_buffer(BIND_TRIANGLE_MAX_DISPLACEMENTS, "self-contact displacements", constants_.TRIANGLES * sizeof(vec4));
  frame_.add_buffer(BIND_SELF_ACTIVE, "self-contact active pairs", active * sizeof(SelfActivePair));
  frame_.add_buffer(BIND_SELF_CONTACTS, "self-contact contacts", touching * CONTACTS_PER_PAIR * sizeof(SelfContact));
  frame_.add_buffer(BIND_SELF_CORRECTIONS, "self-contact corrections", touching * 3 * sizeof(SelfCorrection));
}

FeatureSet XpbdContact::serves() const {
  return scene_.needs &
         (kColliderFeatures | FeatureSet{Feature::Friction, Feature::DoubleSided, Feature::SelfCollision});
}

XpbdContact::Pass XpbdContact::pass(int stage, const char* name, std::uint64_t items, std::uint32_t threads) {
  return {frame_.add_kernel(stage, name, sizeof(ContactConstants), joined(constants_, pass_constants_), threads),
          vulkan::groups_for(items, threads)};
}

void XpbdContact::add_kernels() {
  if (stage_pairs_ < 0) stage_pairs_ = frame_.add_stage("ContactBroadPhase", serves());
  const std::uint32_t n = constants_.VERTICES;
  const std::uint32_t lanes = frame_.device()->shuffled_lanes(), threads = std::max(kGroupSize, lanes);
  const auto at_levels = [](Phase& phase, Pass one, std::uint32_t levels) {
    for (; one.level < levels; ++one.level) phase.push_back(one);
  };
  list_ = {pass(stage_pairs_, "contact_motion_bounds", n)};
  if (constants_.SHAPES > 0)
    at_levels(list_, pass(stage_pairs_, "contact_broad_phase", std::min(constants_.TRIANGLES + n, kPairThreads)),
              holds_all_pairs_ ? 1 : PAIR_LEVELS);
  list_.push_back(pass(stage_pairs_, "contact_finish_broad_phase", n));
  const int stage = frame_.add_stage("ContactSubstep", serves());
  const bool is_software = frame_.device()->is_software();
  const std::uint32_t at_once = is_software ? kSoftwareThreads : kPairThreads,
                      candidates_at_once = is_software ? kSoftwareThreads : kCandidateThreads;
  const std::uint64_t shared = std::uint64_t{constants_.LANES_PER_VERTEX} * n;
  const auto add = [](std::initializer_list<Phase*> phases, const Pass& one) {
    for (Phase* p : phases) p->push_back(one);
  };
  if (kinematic_points_ > 0) add({&before_}, pass(stage, "contact_predict", n));
  const Pass clamp = pass(stage, "contact_clamp", n);
  add({&first_round_}, clamp);
  if (pass_constants_.SECOND_SOLVE != 0) add({&later_round_}, clamp);
  if (constants_.SHAPES > 0) {
    add({&before_, &first_round_}, pass(stage, "contact_find_pairs", candidates_at_once));
    if (constants_.ROUNDS > 1) add({&later_round_}, pass(stage, "contact_respond", at_once));
    add({&end_}, pass(stage, "contact_select_plane", at_once));
  }
  if (with_itself_) {
    add({&first_round_}, pass(stage, "self_aabbs", constants_.TRIANGLES));
    at_levels(first_round_, pass(stage, "self_broad_phase", std::uint64_t{lanes} * constants_.TRIANGLES, threads), 2);
    add({&first_round_}, pass(stage, "self_max_displacement", constants_.TRIANGLES));
    add({&first_round_}, pass(stage, "self_active_pairs", std::uint64_t{lanes} * constants_.TRIANGLES, threads));
    add({&first_round_}, pass(stage, "self_nearest_points", at_once));
    add({&later_round_}, pass(stage, "self_respond", at_once));
    add({&end_}, pass(stage, "self_select_plane", at_once));
  }
  add({&before_, &first_round_, &later_round_}, pass(stage, "contact_accumulate", shared, threads));
  add({&end_}, pass(stage, "contact_project", shared, threads));
}

ContactConstants XpbdContact::constants(int s, int substeps, double dt_s) const {
  const Cloth& cloth = scene_.cloth;
  const Vec3 g = scene_.gravity_m_per_s2;
  const double h = dt_s / substeps;
  const auto f = [](double x) { return static_cast<float>(x); };
  ContactConstants c{};
  c.gravity_h = {f(g[0] * h), f(g[1] * h), f(g[2] * h), 0};
  c.first_substep = static_cast<uint>(s);
  c.substeps = static_cast<uint>(substeps);
  c.substep_part = f(1.0 / substeps);
  c.h = f(h);
  c.per_h = f(1 / h);
  c.damping_fraction = scene_.needs.has(Feature::Damping) ? f(-std::expm1(-scene_.material.damping_per_s * h)) : 0;
  c.frame_s = f(dt_s);
  c.bound_m = f(0.5 * std::max(cloth.du(), cloth.dv()) + std::hypot(g[0], g[1], g[2]) * dt_s * dt_s);
  return c;
}

void XpbdContact::run(const Phase& phase, ContactConstants c) {
  for (const Pass& p : phase) {
    c.level = p.level;
    frame_.dispatch_groups(*p.kernel, p.groups, c);
  }
}

void XpbdContact::record_shapes(double dt_s, int substeps) { run(update_shapes_, constants(0, substeps, dt_s)); }

void XpbdContact::record_list(double dt_s, int substeps) { run(list_, constants(0, substeps, dt_s)); }

void XpbdContact::record_before(int s, int substeps, double dt_s) {
  if (kinematic_points_ > 0) run(before_, constants(s, substeps, dt_s));
}

void XpbdContact::record_after(int s, int substeps, double dt_s, const std::function<void()>& constraints) {
  ContactConstants c = constants(s, substeps, dt_s);
  c.response_round = 1;
  run(first_round_, c);
  for (c.response_round = 2; c.response_round <= constants_.ROUNDS; ++c.response_round) {
    constraints();
    run(later_round_, c);
  }
  run(end_, c);
}

ContactDiagnostics XpbdContact::diagnostics() const {
  return *static_cast<const ContactDiagnostics*>(diagnostics_->mapped());
}

void XpbdContact::add_measurement(const std::vector<std::uint32_t>& particle) {
  std::vector<StructuralLink> links;
  const auto of = [&](std::uint32_t v) { return particle.empty() ? v : particle[v]; };
  for (const Edge& e : edges(scene_.cloth, EdgeKind::Structural))
    links.push_back({of(e.a), of(e.b), static_cast<float>(e.rest_m)});
  frame_.add_buffer(BIND_LINKS, "contact links", links);
  const int stage = frame_.add_stage("ContactMeasure", serves());
  measure_ = {pass(stage, "contact_measure", std::min<std::uint64_t>(links.size(), kPairThreads))};
}

void XpbdContact::record_measurement() { run(measure_, {}); }

XpbdContact::Measured XpbdContact::read_measured() {
  auto* f = static_cast<ContactDiagnostics*>(diagnostics_->mapped());
  const auto value = [](std::uint32_t& bits) {
    return static_cast<double>(std::bit_cast<float>(std::exchange(bits, 0)));
  };
  return {value(f->max_displacement), value(f->max_strain)};
}

void XpbdContact::set_diagnostics(const ContactDiagnostics& to) { std::memcpy(diagnostics_->mapped(), &to, sizeof to); }

}  // namespace clothbench::pbd_gpu
