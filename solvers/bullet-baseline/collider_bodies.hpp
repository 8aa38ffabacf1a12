#pragma once
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::bullet_baseline {

btVector3 to_bullet(const Vec3&);

/// A scene's colliders as rigid bodies of a Bullet world: static ones, and kinematic ones for capsules.
///
/// Spheres, boxes and capsules are exact. A plane is the top of a large box, like the ground in Bullet's own examples:
/// for soft bodies, Bullet treats btStaticPlaneShape as such a slab, too. A mesh is one thin body per triangle;
/// triangles of a moving mesh keep their initial shape.
class ColliderBodies {
 public:
  /// Adds the bodies to `world`, which must outlive this object. Throws Error on a capsule that changes its length.
  ColliderBodies(const Scene&, btDiscreteDynamicsWorld& world);
  ~ColliderBodies();
  ColliderBodies(const ColliderBodies&) = delete;
  ColliderBodies& operator=(const ColliderBodies&) = delete;

  /// Moves kinematic colliders to the fraction `share` of the straight path from `from` to `to`. Bullet's next step
  /// computes their velocities.
  void move(const FrameMotion& from, const FrameMotion& to, double share);

 private:
  struct Body {
    std::unique_ptr<btCollisionShape> shape;
    std::unique_ptr<btDefaultMotionState> motion;
    std::unique_ptr<btRigidBody> body;
  };
  struct MovingCapsule {
    std::size_t collider, capsule, body;
    btQuaternion turn;
  };
  struct MovingTriangle {
    std::size_t collider, triangle, body;
  };

  void add(std::unique_ptr<btCollisionShape>, const btTransform&, const Collider&, bool moves);
  void add_static(const Collider&);
  void add_mesh(const Scene&, std::size_t collider);
  void add_capsules(const Scene&, std::size_t collider);

  void move_triangles(const FrameMotion& from, const FrameMotion& to, double share);

  const std::vector<Collider>& colliders_;
  btDiscreteDynamicsWorld& world_;
  std::vector<Body> bodies_;
  std::vector<MovingCapsule> capsules_;
  std::vector<MovingTriangle> triangles_;  ///< triangles of one mesh are contiguous
};

}  // namespace clothbench::bullet_baseline
