#include "plane_self.hpp"

#include <algorithm>
#include <bit>

#include "clothbench/error.hpp"
#include "contact_pieces.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Pairs, near pairs and those with contacts that the lists have place for. Heaps list some 200 pairs a triangle, of
/// which 10 are near. Where the list does not suffice, the vertices' reach is cut.
constexpr std::uint32_t kPairsATriangle = 512, kMostSelfPairs = 1u << 24, kNearATriangle = 256, kMostNear = 1u << 22,
                        kTouchingATriangle = 32, kLeastTouching = 1u << 15;
constexpr std::uint32_t kNearThreads = 1u << 14, kSoftwareNearThreads = 1u << 9, kSelfScanThreads = 256;

}  // namespace

PlaneSelf::PlaneSelf(FrameBuilder& frame, const Scene& scene, const std::vector<std::uint32_t>& particle)
    : frame_(frame) {
  auto all = triangles(scene.cloth);
  for (auto& t : all)
    for (auto& v : t) v = particle.empty() ? v : particle[v];
  triangles_ = static_cast<std::uint32_t>(all.size());
  // A short list that tests ask for is one of near pairs too.
  const std::uint32_t wanted = frame_.tuning()["contact_pairs"].get<std::uint32_t>();
  capacity_ = wanted != 0 ? wanted : std::min(kPairsATriangle * triangles_, kMostSelfPairs);
  near_capacity_ = wanted != 0 ? wanted : std::min(kNearATriangle * triangles_, kMostNear);
  touching_capacity_ = std::min(near_capacity_, std::max(kTouchingATriangle * triangles_, kLeastTouching));
  thickness_bits_ = std::bit_cast<std::uint32_t>(static_cast<float>(scene.cloth.self_collision.thickness_m));
  friction_bits_ = std::bit_cast<std::uint32_t>(static_cast<float>(scene.cloth.self_collision.friction));
  const std::uint32_t groups = (triangles_ + PIECES_A_GROUP - 1) / PIECES_A_GROUP;
  frame_.add_buffer(BIND_SELF_ORDER, "self-contact order", cluster(initial_positions(scene), all).triangles);
  frame_.add_buffer(BIND_SELF_BOXES, "self-contact boxes", (triangles_ + groups) * sizeof(SelfBox));
  ranges_ = &frame_.add_buffer(BIND_SELF_RANGES, "self-contact ranges", triangles_ * sizeof(uvec4));
  frame_.add_buffer(BIND_SELF_PAIRS, "self-contact pairs", std::uint64_t{capacity_} * sizeof(SelfPair));
  frame_.add_buffer(BIND_SELF_WAYS, "self-contact ways", triangles_ * sizeof(vec4));
  frame_.add_buffer(BIND_SELF_NEAR, "self-contact near pairs", std::uint64_t{near_capacity_} * sizeof(SelfNear));
  frame_.add_buffer(BIND_SELF_CONTACTS, "self-contact contacts",
                    std::uint64_t{touching_capacity_} * SELF_CONTACTS * sizeof(SelfContact));
  frame_.add_buffer(BIND_SELF_PUSHES, "self-contact pushes", std::uint64_t{touching_capacity_} * 3 * sizeof(SelfPush));
}

const FrameKernel* PlaneSelf::add(int stage, const char* name, const std::vector<std::uint32_t>& constants,
                                  std::uint32_t threads) {
  return frame_.add_kernel(stage, name, static_cast<std::uint32_t>(sizeof(PlaneContactConstants)), constants, threads);
}

void PlaneSelf::add_list_kernels(int stage, PlaneContactSpecialization s) {
  sharers_ = frame_.device()->shuffled_lanes();
  const std::uint32_t subgroups = std::max(kGroupSize, sharers_);
  boxes_ = add(stage, "plane_self_boxes", s.by_number());
  count_ = add(stage, "plane_self_list", s.by_number(), subgroups);
  s.OF_SELF = s.FILL = 1;
  scan_ = frame_.add_kernel(stage, "plane_scan", sizeof(PlaneContactConstants), s.by_number(), kSelfScanThreads,
                            {{BIND_RANGES, ranges_}});
  fill_ = add(stage, "plane_self_list", s.by_number(), subgroups);
}

void PlaneSelf::add_kernels(int stage, const std::vector<std::uint32_t>& constants) {
  ways_ = add(stage, "plane_self_ways", constants);
  near_ = add(stage, "plane_self_near", constants, std::max(kGroupSize, sharers_));
  query_ = add(stage, "plane_self_query", constants);
  respond_ = add(stage, "plane_self_respond", constants);
  choose_ = add(stage, "plane_self_choose", constants);
}

void PlaneSelf::near_pairs(const FrameKernel* kernel, const PlaneContactConstants& c) {
  frame_.dispatch(*kernel, frame_.device()->is_software() ? kSoftwareNearThreads : kNearThreads, c, {});
}

void PlaneSelf::record_list(const PlaneContactConstants& c) {
  const double t = triangles_;
  frame_.dispatch(*boxes_, triangles_, c, {68 * t, 64 * t});
  frame_.dispatch(*count_, std::uint64_t{sharers_} * triangles_, c, {84 * t, 16 * t});
  frame_.dispatch_groups(*scan_, {1, 1}, c, {16 * t, 16 * t});
  frame_.dispatch(*fill_, std::uint64_t{sharers_} * triangles_, c, {100 * t, 0});
}

void PlaneSelf::record_query(const PlaneContactConstants& c) {
  const double t = triangles_;
  frame_.dispatch(*ways_, triangles_, c, {76 * t, 16 * t});
  frame_.dispatch(*near_, std::uint64_t{sharers_} * triangles_, c, {32 * t, 16 * t});
  near_pairs(query_, c);
}

void PlaneSelf::record_response(const PlaneContactConstants& c) { near_pairs(respond_, c); }

void PlaneSelf::record_planes(const PlaneContactConstants& c) { near_pairs(choose_, c); }

}  // namespace clothbench::pbd_gpu
