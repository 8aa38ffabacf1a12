#include "plane_contact.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace clothbench::pbd_gpu {
namespace {

/// Pairs that the list has place for: the lists of heaps and desks are a third of it, and where it does not suffice the
/// vertices' reach is cut.
constexpr std::uint32_t kPairsAnElement = 64, kLeastPairs = 1u << 16, kMostPairs = 1u << 20, kAllPairs = 1u << 18;
constexpr std::uint32_t kPairThreads = 1u << 14, kSoftwareThreads = 1u << 9, kScanThreads = 256;
/// Lanes that share a vertex: the parts of the sum in plane_gather.glsl.
constexpr std::uint32_t kMostTeam = 8;
/// Responses before and after the constraints.
constexpr std::uint32_t kRoundsAfter = 2;

}  // namespace

PlaneContact::PlaneContact(FrameBuilder& frame, const Scene& scene, Vec3 origin_m, const ColliderBuffers* colliders,
                           const std::vector<std::uint32_t>& particle, bool again)
    : frame_(frame), scene_(scene), again_(again), half_spaces_(colliders != nullptr ? colliders->planes.count : 0) {
  const ContactPieces all = contact_pieces(scene, origin_m, colliders);
  frame_.set_contact_margins(all.margins_m);
  most_margin_m_ = all.most_margin_m;
  most_points_ = all.most_points;
  pieces_ = static_cast<std::uint32_t>(all.pieces.size());
  groups_ = static_cast<std::uint32_t>(all.boxes.size() - all.pieces.size());
  moving_points_ = static_cast<std::uint32_t>(all.sources.size());
  if (pieces_ > 0) {
    frame_.add_buffer(BIND_PIECES, "contact pieces", all.pieces);
    frame_.add_buffer(BIND_POINTS, "contact points", all.points);
    frame_.add_buffer(BIND_PIECE_BOXES, "contact piece boxes", all.boxes);
  }
  if (moving_points_ > 0) frame_.add_buffer(BIND_POINT_SOURCES, "contact point sources", all.sources);
  add_elements(particle);
  if (!frame_.counts_bytes() && frame_.tuning()["shuffles"].get<bool>())
    team_ = std::bit_floor(std::clamp(frame_.device()->shuffled_lanes(), 1u, kMostTeam));
  if (scene.needs.has(Feature::SelfCollision)) {
    most_margin_m_ = std::max(most_margin_m_, 0.5 * scene.cloth.self_collision.thickness_m);
    self_ = std::make_unique<PlaneSelf>(frame, scene, particle);
  }
  if (moving_points_ == 0) return;
  stage_pairs_ = frame_.add_stage("PlanePairs", serves(), true);
  moved_ = frame_.add_kernel(stage_pairs_, "plane_pieces", sizeof(PlaneContactConstants), specialization().by_number(),
                             kGroupSize);
}

void PlaneContact::add_elements(const std::vector<std::uint32_t>& particle) {
  const auto n = static_cast<std::uint32_t>(scene_.cloth.vertex_count());
  const auto of = [&](std::uint32_t v) { return particle.empty() ? v : particle[v]; };
  std::vector<uvec4> elements;
  std::vector<std::vector<std::uint32_t>> fans(n);
  for (const auto& t : triangles(scene_.cloth)) {
    const auto number = static_cast<std::uint32_t>(elements.size());
    elements.push_back({of(t[0]), of(t[1]), of(t[2]), 3});
    for (std::uint32_t corner = 0; corner < 3; ++corner) fans[of(t[corner])].push_back(4 * number + corner);
  }
  triangles_ = static_cast<std::uint32_t>(elements.size());
  for (std::uint32_t v = 0; v < n; ++v) elements.push_back({v, v, v, 1});
  std::vector<std::uint32_t> all;
  auto first = n + 1;
  for (const auto& fan : fans) {
    all.push_back(first);
    first += static_cast<std::uint32_t>(fan.size());
  }
  all.push_back(first);
  for (const auto& fan : fans) all.insert(all.end(), fan.begin(), fan.end());
  const auto count = static_cast<std::uint32_t>(elements.size());
  capacity_ = frame_.tuning()["contact_pairs"].get<std::uint32_t>();
  if (capacity_ == 0) {
    // A long oblique triangle has a box that meets much of the cloth, so small scenes get a list of all their pairs.
    const std::uint64_t all_pairs = std::uint64_t{count} * pieces_;
    capacity_ = std::clamp(kPairsAnElement * count, kLeastPairs, kMostPairs);
    capacity_ = std::max(capacity_, static_cast<std::uint32_t>(std::min<std::uint64_t>(all_pairs, kAllPairs)));
  }
  frame_.add_buffer(BIND_ELEMENTS, "contact elements", elements);
  frame_.add_buffer(BIND_FANS, "contact fans", all);
  frame_.add_buffer(BIND_RANGES, "contact ranges", count * sizeof(uvec4));
  frame_.add_buffer(BIND_TOUCHED, "contact touched", 4 * std::uint64_t{n} * sizeof(uint));
  frame_.add_buffer(BIND_NEAR_BITS, "contact near pairs", 2 * std::uint64_t{capacity_ / 32 + 1} * sizeof(uint));
  frame_.add_buffer(BIND_PAIRS, "contact pairs", std::uint64_t{capacity_} * sizeof(uvec4));
  frame_.add_buffer(BIND_PAIR_STATES, "contact pair states", std::uint64_t{capacity_} * sizeof(PairState));
  ContactLedger ledger{};
  std::fill(std::begin(ledger.cloth_low), std::end(ledger.cloth_low), ~0u);
  frame_.add_buffer(BIND_LEDGER, "contact ledger", std::vector{ledger});
  frame_.add_buffer(BIND_PREDICTED, "contact proposals", n * sizeof(vec4));
  frame_.add_buffer(BIND_STARTS, "contact starts", n * sizeof(vec4));
  frame_.add_buffer(BIND_REACHES, "contact reaches", n * sizeof(vec4));
  frame_.add_buffer(BIND_WAYS, "contact ways", n * sizeof(float));
  faults_ = &frame_.add_host_buffer("contact faults", sizeof(ContactFaults), BIND_FAULTS);
}

PlaneContactSpecialization PlaneContact::specialization() const {
  PlaneContactSpecialization s;
  s.PLANES = half_spaces_;
  s.GRIPS = static_cast<uint>(scene_.grips.vertices.size());
  s.MOST_POINTS = most_points_;
  s.MOVING = moving_points_ > 0 ? 1 : 0;
  s.TEAM = team_;
  s.AGAIN = again_ ? 1 : 0;
  if (self_) self_->specialize(s);
  return s;
}

PlaneFrameSpecialization PlaneContact::frame_specialization() const {
  PlaneFrameSpecialization s;
  s.PLANES = half_spaces_;
  s.MOST_POINTS = most_points_;
  s.MOVING = moving_points_ > 0 ? 1 : 0;
  s.TEAM = team_;
  s.VERTICES = static_cast<uint>(scene_.cloth.vertex_count());
  s.TRIANGLES = triangles_;
  s.CAPACITY = capacity_;
  s.PIECES = pieces_;
  s.GROUPS = groups_;
  s.MARGIN_BITS = std::bit_cast<uint>(static_cast<float>(most_margin_m_));
  if (self_) self_->specialize(s);
  return s;
}

FeatureSet PlaneContact::serves() const {
  return scene_.needs &
         (kColliderFeatures | FeatureSet{Feature::Friction, Feature::DoubleSided, Feature::SelfCollision});
}

const FrameKernel* PlaneContact::add(int stage, const char* name, std::uint32_t threads) {
  return frame_.add_kernel(stage, name, static_cast<std::uint32_t>(sizeof(PlaneContactConstants)),
                           specialization().by_number(), threads);
}

void PlaneContact::add_self_list_kernels() {
  if (stage_pairs_ < 0) stage_pairs_ = frame_.add_stage("PlanePairs", serves(), true);
  reach_ = add(stage_pairs_, "plane_reach");
  if (self_) self_->add_list_kernels(stage_pairs_, specialization().by_number());
}

void PlaneContact::add_kernels() {
  add_self_list_kernels();
  stage_ = frame_.add_stage("PlaneContact", serves(), true);
  if (pieces_ > 0) {
    count_ = add(stage_pairs_, "plane_list");
    scan_ = add(stage_pairs_, "plane_scan", kScanThreads);
    fill_ = add(stage_pairs_, "plane_list_fill");
    near_ = add(stage_, "plane_near");
    query_ = add(stage_, "plane_query");
    respond_ = add(stage_, "plane_respond");
    choose_ = add(stage_, "plane_choose");
  }
  if (self_) self_->add_kernels(stage_, specialization().by_number());
  if (moving_points_ > 0) predict_ = add(stage_, "plane_predict");
  gather_ = add(stage_, team_ > 1 ? "plane_gather_shuffle" : "plane_gather");
  settle_ = add(stage_, "plane_settle");
  project_ = add(stage_, team_ > 1 ? "plane_project_shuffle" : "plane_project");
}

PlaneContactConstants PlaneContact::constants(int s, int substeps, double dt_s) const {
  const Cloth& cloth = scene_.cloth;
  const Vec3 g = scene_.gravity_m_per_s2;
  const double h = dt_s / substeps;
  const auto f = [](double x) { return static_cast<float>(x); };
  PlaneContactConstants c{};
  c.gravity_h = {f(g[0] * h), f(g[1] * h), f(g[2] * h), 0};
  c.vertices = static_cast<uint>(cloth.vertex_count());
  c.triangles = triangles_;
  c.capacity = capacity_;
  c.pieces = pieces_;
  c.groups = groups_;
  c.first_substep = static_cast<uint>(s);
  c.substeps = static_cast<uint>(substeps);
  c.substep_part = f(1.0 / substeps);
  c.h = f(h);
  c.per_h = f(1 / h);
  c.loss = scene_.needs.has(Feature::Damping) ? f(-std::expm1(-scene_.material.damping_per_s * h)) : 0;
  c.frame_s = f(dt_s);
  c.reach_m = f(0.5 * std::max(cloth.du(), cloth.dv()) + std::hypot(g[0], g[1], g[2]) * dt_s * dt_s);
  c.margin_m = f(most_margin_m_);
  return c;
}

void PlaneContact::vertices(const FrameKernel* kernel, const PlaneContactConstants& c) {
  frame_.dispatch(*kernel, c.vertices, c, {16.0 * c.vertices, 16.0 * c.vertices});
}

void PlaneContact::shared_vertices(const FrameKernel* kernel, const PlaneContactConstants& c) {
  // What no contact moves is read and not written.
  frame_.dispatch(*kernel, std::uint64_t{team_} * c.vertices, c, {16.0 * c.vertices, 0});
}

void PlaneContact::pairs(const FrameKernel* kernel, const PlaneContactConstants& c) {
  const std::uint32_t threads = frame_.device()->is_software() ? kSoftwareThreads : kPairThreads;
  if (kernel != nullptr) frame_.dispatch(*kernel, threads, c, {});
}

void PlaneContact::record_pieces(double dt_s, int substeps) {
  if (moved_ == nullptr) return;
  frame_.dispatch_groups(*moved_, vulkan::groups_for(groups_, 1), constants(0, substeps, dt_s),
                         {48.0 * moving_points_, 32.0 * moving_points_ + 32.0 * groups_});
}

void PlaneContact::record_self_list(double dt_s, int substeps) {
  const PlaneContactConstants c = constants(0, substeps, dt_s);
  vertices(reach_, c);
  if (self_) self_->record_list(c);
}

void PlaneContact::record_list(double dt_s, int substeps) {
  record_self_list(dt_s, substeps);
  if (pieces_ == 0) return;
  const PlaneContactConstants c = constants(0, substeps, dt_s);
  const std::uint32_t elements = c.triangles + c.vertices;
  frame_.dispatch(*count_, std::min(elements, kPairThreads), c, {32.0 * elements, 16.0 * elements});
  frame_.dispatch_groups(*scan_, {1, 1}, c, {16.0 * elements, 16.0 * elements});
  frame_.dispatch(*fill_, std::min(elements, kPairThreads), c, {32.0 * elements, 0});
}

void PlaneContact::record_before(int s, int substeps, double dt_s) {
  if (moving_points_ == 0) return;
  const PlaneContactConstants c = constants(s, substeps, dt_s);
  vertices(predict_, c);
  pairs(near_, c);
  pairs(query_, c);
  shared_vertices(gather_, c);
}

void PlaneContact::record_after(int s, int substeps, double dt_s, const std::function<void()>& constraints) {
  PlaneContactConstants c = constants(s, substeps, dt_s);
  c.turn = 1;
  vertices(settle_, c);
  pairs(near_, c);
  pairs(query_, c);
  if (self_) self_->record_query(c);
  shared_vertices(gather_, c);
  for (c.turn = 2; c.turn <= kRoundsAfter; ++c.turn) {
    if (again_) {
      constraints();
      vertices(settle_, c);
    }
    pairs(respond_, c);
    if (self_) self_->record_response(c);
    shared_vertices(gather_, c);
  }
  pairs(choose_, c);
  if (self_) self_->record_planes(c);
  shared_vertices(project_, c);
}

ContactFaults PlaneContact::faults() const {
  ContactFaults f{};
  std::memcpy(&f, faults_->mapped(), sizeof f);
  return f;
}

double PlaneContact::take_farthest_m(bool whole_frame) {
  auto* f = static_cast<ContactFaults*>(faults_->mapped());
  const double farthest = static_cast<double>(std::bit_cast<float>(f->farthest));
  f->farthest = whole_frame ? std::bit_cast<std::uint32_t>(std::numeric_limits<float>::infinity()) : 0;
  return farthest;
}

void PlaneContact::clear_faults() { std::memset(faults_->mapped(), 0, sizeof(ContactFaults)); }

}  // namespace clothbench::pbd_gpu
