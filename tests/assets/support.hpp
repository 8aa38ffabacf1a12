#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "assets/assets.hpp"
#include "assets/base64.hpp"
#include "refusal.hpp"
#include "scenario/collider_reader.hpp"

namespace clothbench::assets {

/// The npm assets. Without them, skips with the reason, or fails if CLOTHBENCH_REQUIRE_ASSETS=1.
#define NEED_NPM_ASSETS(source)                                                                    \
  const char* required_ = std::getenv("CLOTHBENCH_REQUIRE_ASSETS");                                \
  const AssetSource source = locate_assets(required_ != nullptr && std::string(required_) == "1"); \
  if (!source.npm) GTEST_SKIP() << "no npm assets: " << source.reason

/// Message of the Error of bad input that `f` throws.
inline std::string error_of(const std::function<void()>& f) { return refusal(f, ExitCode::BadInput); }

template <class Item>
std::string base64_of(const std::vector<Item>& items) {
  return encode_base64(reinterpret_cast<const std::uint8_t*>(items.data()), items.size() * sizeof(Item));
}

/// Positions of a hand's vertices as passed to solvers.
inline std::vector<double> skinned(const Hand& hand, const JointFrames& joints) {
  return posed_positions(*collider_mesh(hand.mesh), mesh_pose(hand, joints, Vector::Zero()));
}

inline TriangleMesh tetrahedron() {
  return {{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

}  // namespace clothbench::assets
