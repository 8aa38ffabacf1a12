/// Jolt's headers, its layers and conversions.
#pragma once

// clang-format off: Jolt.h comes before every other header of the engine.
#include <Jolt/Jolt.h>
// clang-format on

#include <Jolt/Core/Factory.h>
#include <Jolt/Core/JobSystemSingleThreaded.h>
#include <Jolt/Core/TempAllocator.h>
#include <Jolt/Physics/Body/BodyCreationSettings.h>
#include <Jolt/Physics/Collision/BroadPhase/BroadPhaseLayerInterfaceTable.h>
#include <Jolt/Physics/Collision/BroadPhase/ObjectVsBroadPhaseLayerFilterTable.h>
#include <Jolt/Physics/Collision/ObjectLayerPairFilterTable.h>
#include <Jolt/Physics/Collision/Shape/BoxShape.h>
#include <Jolt/Physics/Collision/Shape/CapsuleShape.h>
#include <Jolt/Physics/Collision/Shape/MeshShape.h>
#include <Jolt/Physics/Collision/Shape/PlaneShape.h>
#include <Jolt/Physics/Collision/Shape/SphereShape.h>
#include <Jolt/Physics/PhysicsSystem.h>
#include <Jolt/Physics/SoftBody/SoftBodyCreationSettings.h>
#include <Jolt/Physics/SoftBody/SoftBodyMotionProperties.h>
#include <Jolt/Physics/SoftBody/SoftBodySharedSettings.h>
#include <Jolt/RegisterTypes.h>

#include "peer.hpp"

namespace clothbench::jolt {

/// Two layers: the cloth meets obstacles, obstacles do not meet.
constexpr JPH::ObjectLayer kCloth = 0, kObstacle = 1;

/// A point of the world [m] in the engine's float32, around `origin`.
inline JPH::Vec3 to_engine(const peer::Point& x, const peer::Point& origin) {
  const auto to = [&](std::size_t k) { return static_cast<float>(x[k] - origin[k]); };
  return {to(0), to(1), to(2)};
}

}  // namespace clothbench::jolt
