#include "xpbd/contact/contact.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "clothbench/error.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Pairs that the list has place for: the lists of heaps and desks are a third of it, and where it does not suffice the
/// vertices' motion bounds is cut.
constexpr std::uint32_t kPairsPerPrimitive = 64, kMinPairs = 1u << 16, kMaxPairs = 1u << 20;
constexpr std::uint64_t kAllPairs = 1u << 18;
constexpr std::uint32_t kPairThreads = 1u << 14, kSoftwareThreads = 1u << 9, kScanThreads = 256;
/// Lanes that share a vertex: the parts of the sum in contact_accumulate.glsl.
constexpr std::uint32_t kMaxLanesPerVertex = 8;
/// Responses before and after the constraints.
constexpr std::uint32_t kRoundsAfter = 2;

}  // namespace

XpbdContact::XpbdContact(FrameBuilder& frame, const Scene& scene, Vec3 origin_m, const ColliderBuffers* colliders,
                         const std::vector<std::uint32_t>& particle, bool again)
    : frame_(frame),
      scene_(scene),
      second_solve_(again),
      half_spaces_(colliders != nullptr ? colliders->planes.count : 0) {
  const ConvexShapes all = convex_shapes(scene, origin_m, colliders);
  frame_.set_contact_margins(all.margins_m);
  max_margin_m_ = all.max_margin_m;
  max_points_ = all.max_points;
  shapes_ = static_cast<std::uint32_t>(all.shapes.size());
  groups_ = static_cast<std::uint32_t>(all.boxes.size() - all.shapes.size());
  kinematic_points_ = static_cast<std::uint32_t>(all.sources.size());
  if (shapes_ > 0) {
    frame_.add_buffer(BIND_SHAPES, "contact convex shapes", all.shapes);
    frame_.add_buffer(BIND_POINTS, "contact points", all.points);
    frame_.add_buffer(BIND_SHAPE_AABBS, "contact convex shape boxes", all.boxes);
  }
  if (kinematic_points_ > 0) frame_.add_buffer(BIND_POINT_SOURCES, "contact point sources", all.sources);
  add_primitives(particle);
  lanes_per_vertex_ = std::bit_floor(std::clamp(frame_.device()->shuffled_lanes(), 1u, kMaxLanesPerVertex));
  if (scene.needs.has(Feature::SelfCollision)) {
    max_margin_m_ = std::max(max_margin_m_, 0.5 * scene.cloth.self_collision.thickness_m);
    self_ = std::make_unique<SelfContactKernels>(frame, scene, particle);
  }
  if (kinematic_points_ == 0) return;
  stage_pairs_ = frame_.add_stage("ContactBroadPhase", serves(), true);
  update_shapes_ = frame_.add_kernel(stage_pairs_, "contact_update_shapes", sizeof(ContactConstants),
                                     specialization().by_number(), kGroupSize);
}

void XpbdContact::add_primitives(const std::vector<std::uint32_t>& particle) {
  const auto n = static_cast<std::uint32_t>(scene_.cloth.vertex_count());
  const auto of = [&](std::uint32_t v) { return particle.empty() ? v : particle[v]; };
  std::vector<uvec4> primitives;
  std::vector<std::vector<std::uint32_t>> vertex_triangles(n);
  for (const auto& t : triangles(scene_.cloth)) {
    const auto number = static_cast<std::uint32_t>(primitives.size());
    primitives.push_back({of(t[0]), of(t[1]), of(t[2]), 3});
    for (std::uint32_t corner = 0; corner < 3; ++corner) vertex_triangles[of(t[corner])].push_back(4 * number + corner);
  }
  triangles_ = static_cast<std::uint32_t>(primitives.size());
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
  capacity_ = frame_.tuning()["contact_pairs"].get<std::uint32_t>();
  if (capacity_ == 0) {
    // The AABB of a long oblique triangle overlaps much of the cloth, so small scenes get a list of all their pairs.
    const auto all_pairs = static_cast<std::uint32_t>(std::min(std::uint64_t{count} * shapes_, kAllPairs));
    capacity_ = std::max(std::clamp(kPairsPerPrimitive * count, kMinPairs, kMaxPairs), all_pairs);
  }
  frame_.add_buffer(BIND_PRIMITIVES, "contact primitives", primitives);
  frame_.add_buffer(BIND_VERTEX_TRIANGLES, "contact fans", all);
  frame_.add_buffer(BIND_RANGES, "contact ranges", count * sizeof(uvec4));
  frame_.add_buffer(BIND_TOUCHED, "contact touched", 4 * std::uint64_t{n} * sizeof(uint));
  frame_.add_buffer(BIND_ACTIVE_BITS, "contact active pairs", 2 * std::uint64_t{capacity_ / 32 + 1} * sizeof(uint));
  frame_.add_buffer(BIND_PAIRS, "contact pairs", std::uint64_t{capacity_} * sizeof(uvec4));
  frame_.add_buffer(BIND_PAIR_STATES, "contact pair states", std::uint64_t{capacity_} * sizeof(PairState));
  ContactFrameState frame_state{};
  std::fill(std::begin(frame_state.cloth_low), std::end(frame_state.cloth_low), ~0u);
  frame_.add_buffer(BIND_FRAME_STATE, "contact ledger", std::vector{frame_state});
  frame_.add_buffer(BIND_PREDICTED, "contact proposals", n * sizeof(vec4));
  frame_.add_buffer(BIND_STARTS, "contact starts", n * sizeof(vec4));
  frame_.add_buffer(BIND_MOTION_BOUNDS, "contact reaches", n * sizeof(vec4));
  frame_.add_buffer(BIND_VERTEX_DISPLACEMENTS, "contact ways", n * sizeof(float));
  diagnostics_ = &frame_.add_host_buffer("contact faults", sizeof(ContactDiagnostics), BIND_DIAGNOSTICS);
}

ContactSpecialization XpbdContact::specialization() const {
  ContactSpecialization s;
  s.PLANES = half_spaces_;
  s.GRIPS = static_cast<uint>(scene_.grips.vertices.size());
  s.MAX_POINTS = max_points_;
  s.HAS_KINEMATIC = kinematic_points_ > 0 ? 1 : 0;
  s.LANES_PER_VERTEX = lanes_per_vertex_;
  s.SECOND_SOLVE = second_solve_ ? 1 : 0;
  if (self_) self_->specialize(s);
  return s;
}

FusedFrameSpecialization XpbdContact::frame_specialization() const {
  FusedFrameSpecialization s;
  s.PLANES = half_spaces_;
  s.MAX_POINTS = max_points_;
  s.HAS_KINEMATIC = kinematic_points_ > 0 ? 1 : 0;
  s.LANES_PER_VERTEX = lanes_per_vertex_;
  s.VERTICES = static_cast<uint>(scene_.cloth.vertex_count());
  s.TRIANGLES = triangles_;
  s.CAPACITY = capacity_;
  s.SHAPES = shapes_;
  s.GROUPS = groups_;
  s.MARGIN_BITS = std::bit_cast<uint>(static_cast<float>(max_margin_m_));
  return s;
}

FeatureSet XpbdContact::serves() const {
  return scene_.needs &
         (kColliderFeatures | FeatureSet{Feature::Friction, Feature::DoubleSided, Feature::SelfCollision});
}

const FrameKernel* XpbdContact::add(int stage, const char* name, std::uint32_t threads) {
  return frame_.add_kernel(stage, name, sizeof(ContactConstants), specialization().by_number(), threads);
}

void XpbdContact::add_kernels() {
  if (stage_pairs_ < 0) stage_pairs_ = frame_.add_stage("ContactBroadPhase", serves(), true);
  const std::uint32_t subgroups = std::max(kGroupSize, frame_.device()->shuffled_lanes());
  bounds_ = add(stage_pairs_, "contact_motion_bounds");
  if (self_) self_->add_list_kernels(stage_pairs_, specialization());
  stage_ = frame_.add_stage("ContactSubstep", serves(), true);
  if (shapes_ > 0) {
    count_ = add(stage_pairs_, "contact_broad_phase");
    scan_ = add(stage_pairs_, "prefix_sum", kScanThreads);
    ContactSpecialization fill = specialization();
    fill.FILL = 1;
    fill_ = frame_.add_kernel(stage_pairs_, "contact_broad_phase", sizeof(ContactConstants), fill.by_number());
    active_pairs_ = add(stage_, "contact_active_pairs");
    nearest_points_ = add(stage_, "contact_nearest_points");
    respond_ = add(stage_, "contact_respond");
    select_plane_ = add(stage_, "contact_select_plane");
  }
  if (self_) self_->add_kernels(stage_, specialization().by_number());
  if (kinematic_points_ > 0) predict_ = add(stage_, "contact_predict");
  accumulate_ = add(stage_, "contact_accumulate", subgroups);
  clamp_ = add(stage_, "contact_clamp");
  project_ = add(stage_, "contact_project", subgroups);
}

ContactConstants XpbdContact::constants(int s, int substeps, double dt_s) const {
  const Cloth& cloth = scene_.cloth;
  const Vec3 g = scene_.gravity_m_per_s2;
  const double h = dt_s / substeps;
  const auto f = [](double x) { return static_cast<float>(x); };
  ContactConstants c{};
  c.gravity_h = {f(g[0] * h), f(g[1] * h), f(g[2] * h), 0};
  c.vertices = static_cast<uint>(cloth.vertex_count());
  c.triangles = triangles_;
  c.capacity = capacity_;
  c.shapes = shapes_;
  c.groups = groups_;
  c.first_substep = static_cast<uint>(s);
  c.substeps = static_cast<uint>(substeps);
  c.substep_part = f(1.0 / substeps);
  c.h = f(h);
  c.per_h = f(1 / h);
  c.damping_fraction = scene_.needs.has(Feature::Damping) ? f(-std::expm1(-scene_.material.damping_per_s * h)) : 0;
  c.frame_s = f(dt_s);
  c.bound_m = f(0.5 * std::max(cloth.du(), cloth.dv()) + std::hypot(g[0], g[1], g[2]) * dt_s * dt_s);
  c.margin_m = f(max_margin_m_);
  return c;
}

void XpbdContact::vertices(const FrameKernel* kernel, const ContactConstants& c) {
  frame_.dispatch(*kernel, c.vertices, c, {16.0 * c.vertices, 16.0 * c.vertices});
}

void XpbdContact::shared_vertices(const FrameKernel* kernel, const ContactConstants& c) {
  // What no contact moves is read and not written.
  frame_.dispatch(*kernel, std::uint64_t{lanes_per_vertex_} * c.vertices, c, {16.0 * c.vertices, 0});
}

void XpbdContact::pairs(const FrameKernel* kernel, const ContactConstants& c) {
  const std::uint32_t threads = frame_.device()->is_software() ? kSoftwareThreads : kPairThreads;
  if (kernel != nullptr) frame_.dispatch(*kernel, threads, c, {});
}

void XpbdContact::record_shapes(double dt_s, int substeps) {
  if (update_shapes_ == nullptr) return;
  frame_.dispatch_groups(*update_shapes_, vulkan::groups_for(groups_, 1), constants(0, substeps, dt_s),
                         {48.0 * kinematic_points_, 32.0 * kinematic_points_ + 32.0 * groups_});
}

void XpbdContact::record_list(double dt_s, int substeps) {
  const ContactConstants c = constants(0, substeps, dt_s);
  vertices(bounds_, c);
  if (self_) self_->record_list(c);
  if (shapes_ == 0) return;
  const std::uint32_t primitives = c.triangles + c.vertices;
  frame_.dispatch(*count_, std::min(primitives, kPairThreads), c, {32.0 * primitives, 16.0 * primitives});
  frame_.dispatch_groups(*scan_, {1, 1}, c, {16.0 * primitives, 16.0 * primitives});
  frame_.dispatch(*fill_, std::min(primitives, kPairThreads), c, {32.0 * primitives, 0});
}

void XpbdContact::record_before(int s, int substeps, double dt_s) {
  if (kinematic_points_ == 0) return;
  const ContactConstants c = constants(s, substeps, dt_s);
  vertices(predict_, c);
  pairs(active_pairs_, c);
  pairs(nearest_points_, c);
  shared_vertices(accumulate_, c);
}

void XpbdContact::record_after(int s, int substeps, double dt_s, const std::function<void()>& constraints) {
  ContactConstants c = constants(s, substeps, dt_s);
  c.response_round = 1;
  vertices(clamp_, c);
  pairs(active_pairs_, c);
  pairs(nearest_points_, c);
  if (self_) self_->record_query(c);
  shared_vertices(accumulate_, c);
  for (c.response_round = 2; c.response_round <= kRoundsAfter; ++c.response_round) {
    if (second_solve_) {
      constraints();
      vertices(clamp_, c);
    }
    pairs(respond_, c);
    if (self_) self_->record_response(c);
    shared_vertices(accumulate_, c);
  }
  pairs(select_plane_, c);
  if (self_) self_->record_planes(c);
  shared_vertices(project_, c);
}

ContactDiagnostics XpbdContact::diagnostics() const {
  ContactDiagnostics f{};
  std::memcpy(&f, diagnostics_->mapped(), sizeof f);
  return f;
}

double XpbdContact::read_max_displacement_m(bool is_single_dispatch) {
  auto* f = static_cast<ContactDiagnostics*>(diagnostics_->mapped());
  const double max_displacement = static_cast<double>(std::bit_cast<float>(f->max_displacement));
  f->max_displacement = is_single_dispatch ? std::bit_cast<std::uint32_t>(std::numeric_limits<float>::infinity()) : 0;
  return max_displacement;
}

void XpbdContact::clear_diagnostics() { std::memset(diagnostics_->mapped(), 0, sizeof(ContactDiagnostics)); }

namespace {

/// Pairs, active pairs and those with contacts that the lists have place for. Heaps list some 200 pairs per triangle,
/// of which 10 are active. Where the list does not suffice, the vertices' motion bounds is cut.
constexpr std::uint32_t kPairsPerTriangle = 512, kMaxSelfPairs = 1u << 24, kActivePerTriangle = 256,
                        kMaxActive = 1u << 22, kContactPairsPerTriangle = 32, kMinContactPairs = 1u << 15;
constexpr std::uint32_t kActiveThreads = 1u << 14, kSoftwareActiveThreads = 1u << 9, kSelfScanThreads = 256;

}  // namespace

SelfContactKernels::SelfContactKernels(FrameBuilder& frame, const Scene& scene,
                                       const std::vector<std::uint32_t>& particle)
    : frame_(frame) {
  auto all = triangles(scene.cloth);
  for (auto& t : all)
    for (auto& v : t) v = particle.empty() ? v : particle[v];
  triangles_ = static_cast<std::uint32_t>(all.size());
  // A short list that tests ask for is one of active pairs too.
  const std::uint32_t wanted = frame_.tuning()["contact_pairs"].get<std::uint32_t>();
  capacity_ = wanted != 0 ? wanted : std::min(kPairsPerTriangle * triangles_, kMaxSelfPairs);
  active_capacity_ = wanted != 0 ? wanted : std::min(kActivePerTriangle * triangles_, kMaxActive);
  contact_capacity_ = std::min(active_capacity_, std::max(kContactPairsPerTriangle * triangles_, kMinContactPairs));
  thickness_bits_ = std::bit_cast<std::uint32_t>(static_cast<float>(scene.cloth.self_collision.thickness_m));
  friction_bits_ = std::bit_cast<std::uint32_t>(static_cast<float>(scene.cloth.self_collision.friction));
  const std::uint32_t groups = (triangles_ + SHAPES_PER_GROUP - 1) / SHAPES_PER_GROUP;
  frame_.add_buffer(BIND_SELF_ORDER, "self-contact order", cluster(initial_positions(scene), all).triangles);
  frame_.add_buffer(BIND_SELF_AABBS, "self-contact boxes", (triangles_ + groups) * sizeof(SelfAabb));
  ranges_ = &frame_.add_buffer(BIND_SELF_RANGES, "self-contact ranges", triangles_ * sizeof(uvec4));
  frame_.add_buffer(BIND_SELF_PAIRS, "self-contact pairs", std::uint64_t{capacity_} * sizeof(SelfPair));
  frame_.add_buffer(BIND_TRIANGLE_MAX_DISPLACEMENTS, "self-contact ways", triangles_ * sizeof(vec4));
  frame_.add_buffer(BIND_SELF_ACTIVE, "self-contact active pairs",
                    std::uint64_t{active_capacity_} * sizeof(SelfActivePair));
  frame_.add_buffer(BIND_SELF_CONTACTS, "self-contact contacts",
                    std::uint64_t{contact_capacity_} * SELF_CONTACTS * sizeof(SelfContact));
  frame_.add_buffer(BIND_SELF_CORRECTIONS, "self-contact pushes",
                    std::uint64_t{contact_capacity_} * 3 * sizeof(SelfCorrection));
}

const FrameKernel* SelfContactKernels::add(int stage, const char* name, const std::vector<std::uint32_t>& constants,
                                           std::uint32_t threads) {
  return frame_.add_kernel(stage, name, static_cast<std::uint32_t>(sizeof(ContactConstants)), constants, threads);
}

void SelfContactKernels::add_list_kernels(int stage, ContactSpecialization s) {
  lanes_per_triangle_ = frame_.device()->shuffled_lanes();
  const std::uint32_t subgroups = std::max(kGroupSize, lanes_per_triangle_);
  boxes_ = add(stage, "self_aabbs", s.by_number());
  count_ = add(stage, "self_broad_phase", s.by_number(), subgroups);
  s.OF_SELF = s.FILL = 1;
  scan_ = frame_.add_kernel(stage, "prefix_sum", sizeof(ContactConstants), s.by_number(), kSelfScanThreads,
                            {{BIND_RANGES, ranges_}});
  fill_ = add(stage, "self_broad_phase", s.by_number(), subgroups);
}

void SelfContactKernels::add_kernels(int stage, const std::vector<std::uint32_t>& constants) {
  displacement_kernel_ = add(stage, "self_max_displacement", constants);
  active_pairs_ = add(stage, "self_active_pairs", constants, std::max(kGroupSize, lanes_per_triangle_));
  nearest_points_ = add(stage, "self_nearest_points", constants);
  respond_ = add(stage, "self_respond", constants);
  select_plane_ = add(stage, "self_select_plane", constants);
}

void SelfContactKernels::active_pairs(const FrameKernel* kernel, const ContactConstants& c) {
  frame_.dispatch(*kernel, frame_.device()->is_software() ? kSoftwareActiveThreads : kActiveThreads, c, {});
}

void SelfContactKernels::record_list(const ContactConstants& c) {
  const double t = triangles_;
  frame_.dispatch(*boxes_, triangles_, c, {68 * t, 64 * t});
  frame_.dispatch(*count_, std::uint64_t{lanes_per_triangle_} * triangles_, c, {84 * t, 16 * t});
  frame_.dispatch_groups(*scan_, {1, 1}, c, {16 * t, 16 * t});
  frame_.dispatch(*fill_, std::uint64_t{lanes_per_triangle_} * triangles_, c, {100 * t, 0});
}

void SelfContactKernels::record_query(const ContactConstants& c) {
  const double t = triangles_;
  frame_.dispatch(*displacement_kernel_, triangles_, c, {76 * t, 16 * t});
  frame_.dispatch(*active_pairs_, std::uint64_t{lanes_per_triangle_} * triangles_, c, {32 * t, 16 * t});
  active_pairs(nearest_points_, c);
}

void SelfContactKernels::record_response(const ContactConstants& c) { active_pairs(respond_, c); }

void SelfContactKernels::record_planes(const ContactConstants& c) { active_pairs(select_plane_, c); }

}  // namespace clothbench::pbd_gpu
