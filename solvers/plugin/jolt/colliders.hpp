/// A scene's colliders as bodies in Jolt.
#pragma once

#include "jolt/engine.hpp"

namespace clothbench::jolt {

/// Spheres, boxes, planes and meshes are static bodies, each capsule a kinematic one. A mesh that moves gets a new
/// shape every frame: the engine's mesh shapes cannot deform.
class Colliders {
 public:
  Colliders(const ClothbenchScene&, const peer::Point& origin);

  /// Adds the bodies to an empty system, at these poses. Throws std::runtime_error with the engine's message if it
  /// refuses a shape.
  void add(JPH::PhysicsSystem&, const ClothbenchPose*);
  /// Lets moving colliders reach the frame's poses at its end; one that teleports is there at once.
  void move(JPH::PhysicsSystem&, const ClothbenchFrame&);

 private:
  void add_body(JPH::PhysicsSystem&, const ClothbenchCollider&, const JPH::Shape*, JPH::Vec3 at, JPH::Quat turn,
                JPH::EMotionType);
  void add_capsules(JPH::PhysicsSystem&, const ClothbenchCollider&, const double* capsules);
  JPH::Ref<JPH::Shape> mesh(const ClothbenchCollider&, const double* vertices_m) const;

  const ClothbenchScene& scene_;
  peer::Point origin_;
  std::vector<std::vector<JPH::BodyID>> bodies_;  ///< of each collider
};

}  // namespace clothbench::jolt
