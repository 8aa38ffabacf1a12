#include "xpbd_self_contact.hpp"

#include <algorithm>

#include "clothbench/error.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Rounds of corrections a substep: each resolves contacts of a pile that the previous one left.
constexpr int kRounds = 2;

/// Reaches in thicknesses, consistent with self.glsl. Contact begins a twentieth of the thickness outside. For crossing
/// only the displacements matter.
constexpr float kContactReach = 1.05f, kCrossingReach = 2e-4f;

/// Most blocks, because every pair of blocks is compared in each search, and least vertices along a block's side.
constexpr std::uint32_t kMostBlocks = 4096, kLeastSide = 2;

std::uint32_t blocks_along(int vertices, std::uint32_t side) {
  return (static_cast<std::uint32_t>(vertices) + side - 1) / side;
}

}  // namespace

XpbdSelfContact::XpbdSelfContact(FrameBuilder& frame, const Scene& scene, const vulkan::Buffer& positions)
    : frame_(frame), scene_(scene), x_(positions) {
  const Cloth& c = scene.cloth;
  if (c.mesh) throw Error("solver xpbd: self-collision: expected a cloth that is a grid, not a triangle mesh");
  if (frame.settings()["batch"] != 1)
    throw Error("solver xpbd: setting batch: expected a scene without self-collision");
  for (side_ = kLeastSide; blocks_ == 0 || blocks_ > kMostBlocks; side_ *= 2) {
    block_columns_ = blocks_along(c.columns, side_);
    blocks_ = block_columns_ * blocks_along(c.rows, side_);
    if (blocks_ <= kMostBlocks) break;
  }
  words_ = (blocks_ + 31) / 32;
  FeatureSet serves = {Feature::SelfCollision};
  if (c.self_collision.friction > 0) serves.add(Feature::Friction);
  stage_start_ = frame_.add_stage("KeepStart", {Feature::SelfCollision});
  stage_ = frame_.add_stage("SelfContact", serves, true);
  const std::size_t n = c.vertex_count();
  starts_ = &frame_.add_buffer(BIND_STARTS, "self-contact starts", n * sizeof(vec4));
  frame_.add_buffer(BIND_BLOCKS, "self-contact blocks", 3 * blocks_ * sizeof(vec4));
  frame_.add_buffer(BIND_NEAR, "self-contact near blocks", std::uint64_t{4} * blocks_ * words_);
  // 13 slots of two vec4 a vertex: one for itself, six for its two triangles, six for its three edges.
  frame_.add_buffer(BIND_PROPOSED, "self-contact corrections", 26 * n * sizeof(vec4));
  frame_.add_buffer(BIND_PART, "self-contact certified part", 4);
  const auto add = [&](const char* name) { return frame_.add_kernel(stage_, name, sizeof(SelfConstants)); };
  find_blocks_ = add("self_blocks");
  find_near_ = add("self_near");
  correct_ = add("self_corrections");
  apply_ = add("self_apply");
  certify_ = add("self_certify");
  move_ = add("self_move");
}

SelfConstants XpbdSelfContact::constants(double h) const {
  const Cloth& c = scene_.cloth;
  SelfConstants k{};
  k.columns = static_cast<uint>(c.columns);
  k.rows = static_cast<uint>(c.rows);
  k.side = side_;
  k.block_columns = block_columns_;
  k.blocks = blocks_;
  k.words = words_;
  k.thickness_m = static_cast<float>(c.self_collision.thickness_m);
  k.friction = static_cast<float>(c.self_collision.friction);
  k.h = static_cast<float>(h);
  k.most_m = k.thickness_m;
  return k;
}

void XpbdSelfContact::record_frame() { frame_.copy(stage_start_, x_, *starts_); }

void XpbdSelfContact::record_substep(double h) {
  SelfConstants k = constants(h);
  const double n = static_cast<double>(scene_.cloth.vertex_count()), around = 32 + 4.0 * words_;
  k.reach_m = kContactReach * k.thickness_m;
  record_search(k);
  for (int round = 0; round < kRounds; ++round) record_round(k);
  // The corrections changed the displacements.
  k.reach_m = kCrossingReach * k.thickness_m;
  record_search(k);
  const double edges = 3 * n - 2.0 * (k.columns + k.rows) + 1;
  // Traffic of every piece for any shape of the cloth; near pieces add to it.
  frame_.dispatch(*certify_, 4 * scene_.cloth.vertex_count(), k, {n * (16 + around) + edges * (32 + around), 0});
  frame_.dispatch(*move_, scene_.cloth.vertex_count(), k, {36 * n, 32 * n});
}

void XpbdSelfContact::record_search(const SelfConstants& k) {
  const double blocks = blocks_, words = words_;
  // A block reads its own vertices and the first row and column of the next blocks.
  double looked = 0;
  for (uint row = 0; row < k.rows; row += side_)
    for (uint column = 0; column < k.columns; column += side_)
      looked += (std::min(row + side_, k.rows - 1) - row + 1) * (std::min(column + side_, k.columns - 1) - column + 1);
  frame_.dispatch(*find_blocks_, blocks_, k, {32 * looked, 48 * blocks + 4});
  frame_.dispatch(*find_near_, std::uint64_t{blocks_} * words_, k,
                  {48 * blocks * (words + blocks), 4 * blocks * words});
}

void XpbdSelfContact::record_round(const SelfConstants& k) {
  const double columns = k.columns, rows = k.rows, n = columns * rows, cells = (columns - 1) * (rows - 1);
  const double edges = 3 * n - 2 * (columns + rows) + 1, around = 32 + 4.0 * words_;
  frame_.dispatch(
      *correct_, 6 * scene_.cloth.vertex_count(), k,
      {n * (16 + around) + 2 * cells * (48 + around) + edges * (32 + around), 32 * n + 96 * 2 * cells + 64 * edges});
  Traffic t;
  const std::vector<float>& w = frame_.inverse_mass_now();
  for (std::size_t i = 0; i < w.size(); ++i) {
    const bool right = i % k.columns + 1 < k.columns, left = i % k.columns > 0, down = i / k.columns + 1 < k.rows,
               up = i / k.columns > 0;
    const int slots =
        1 + 3 * (right && down) + (left && down) + 3 * (left && up) + (right && up) + right + left + down + up;
    t.read_B += 16 + (w[i] > 0 ? 32.0 * slots + 16 : 0);
    t.write_B += w[i] > 0 ? 32 : 0;
  }
  frame_.dispatch(*apply_, w.size(), k, t);
}

}  // namespace clothbench::pbd_gpu
