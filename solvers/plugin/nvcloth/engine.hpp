/// NvCloth's headers, its units and its start-up.
#pragma once

#include <NvCloth/Callbacks.h>
#include <NvCloth/Cloth.h>
#include <NvCloth/Fabric.h>
#include <NvCloth/Factory.h>
#include <NvCloth/Solver.h>

#include "peer.hpp"

namespace clothbench::nvcloth {

/// The engine's epsilons are absolute (1.2e-7 on squared lengths), so lengths are in centimetres there: in metres a
/// cell of a fine grid comes close to them, and the cloth stretches two to three times more.
constexpr double kPerMetre = 100;

/// A point of the world [m] in the engine's frame [cm], around `origin`; w: radius [cm], inverse mass or nothing.
inline physx::PxVec4 to_engine(const peer::Point& x, const peer::Point& origin, double w) {
  const auto to = [&](std::size_t k) { return static_cast<float>((x[k] - origin[k]) * kPerMetre); };
  return {to(0), to(1), to(2), static_cast<float>(w)};
}

template <typename T>
nv::cloth::Range<const T> range(const std::vector<T>& v) {
  return {v.data(), v.data() + v.size()};
}

/// Starts the engine once in a process. Throws std::runtime_error with its last message if `made` is null.
void start_engine();
void require(const void* made, const char* what);

}  // namespace clothbench::nvcloth
