#pragma once
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletSoftBody/btSoftBody.h>
#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "base/json_text.hpp"
#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"

namespace clothbench::bullet_baseline {

btVector3 to_bullet(const Vec3&);

/// A scene's colliders as rigid bodies of a Bullet world: static ones, and kinematic ones for capsules.
///
/// Spheres, boxes and capsules are exact. A plane is the top of a large box, like the ground in Bullet's examples; for
/// soft bodies btStaticPlaneShape is such a box too. A mesh has a thin body per triangle; triangles of a kinematic
/// mesh keep their initial shape.
class ColliderBodies {
 public:
  /// Adds the bodies to `world`, which must outlive this. Throws Error on a capsule that changes its length.
  ColliderBodies(const Scene&, btDiscreteDynamicsWorld& world);
  ~ColliderBodies();
  ColliderBodies(const ColliderBodies&) = delete;
  ColliderBodies& operator=(const ColliderBodies&) = delete;

  /// Moves kinematic colliders to the fraction `share` of their path. Bullet's next step derives their velocities.
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

  void add(std::unique_ptr<btCollisionShape>, const btTransform&, const Collider&);
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

/// Describes a solver of this folder. Its own settings come first, then the contact settings that both solvers share.
SolverInfo bullet_info(const char* name, const char* summary, std::vector<SettingSpec> settings);

/// Fraction of velocity that damping leaves after a step of h [s]: e^(-c h), or 1 without damping.
double kept_share(const Scene&, double h);

/// An integer setting. Throws Error unless it is in [least, most].
int integer_setting(const SolverInfo&, const nlohmann::json& settings, const char* name, int least, int most);
/// A numeric setting. Throws Error unless it is in (least, most].
double number_setting(const SolverInfo&, const nlohmann::json& settings, const char* name, double least, double most);

/// Base of both solvers: the grid cloth as a btSoftBody, the colliders as rigid bodies, and the held vertices. The
/// derived class chooses which of Bullet's two solvers moves the cloth.
class BulletSolver : public ClothSolver {
 public:
  BulletSolver(SolverInfo info, const nlohmann::json& settings);

  const SolverInfo& info() const override { return info_; }
  DeviceInfo device() const override;
  void load(const Scene&) override;
  void reset() override;
  StepStatus step(const FrameInput&) override;
  void read_state(ClothState&) const override;
  bool restart(const ClothState&) override;
  FrameCost last_cost() const override;
  Plan plan() const override;

 protected:
  virtual int substeps_for(const Scene&) const = 0;
  /// Makes a new world, if the scene needs one, and in it the body that new_body() returns.
  virtual void build() = 0;
  /// Removes the body from the world, then destroys the world.
  virtual void tear_down() = 0;
  virtual void substep(btScalar h) = 0;
  /// Called after a vertex was attached or released.
  virtual void masses_changed() = 0;

  /// World of the colliders' rigid bodies; null if the scene has no colliders.
  virtual btDiscreteDynamicsWorld* world() = 0;

  /// Makes a body with its nodes at the scene's positions. Pinned and attached nodes have mass 0, Bullet's mark of a
  /// static node. All that Bullet adds by default is off, including collisions.
  std::unique_ptr<btSoftBody> new_body(btSoftBodyWorldInfo&);
  /// Adds links of one kind with the scene's rest lengths, instead of Bullet's default, the distances at the start.
  static void add_links(btSoftBody&, const Cloth&, EdgeKind);
  /// Sets gravity and the voxel size of the distance fields, and switches air and water off.
  void set_surroundings(btSoftBodyWorldInfo&) const;
  /// Destroys colliders, body and world; called by the destructors of the two solvers.
  void drop();

  const Scene& scene() const { return *scene_; }
  bool touches() const { return !scene_->colliders.empty(); }
  double contact_margin_m() const;

  std::unique_ptr<btSoftBody> body_;

 private:
  /// Sets velocities that bring held vertices to the fraction `share` of their path from the last frame's end to `end`.
  void hold(const FrameMotion& end, double share, btScalar h);
  void let_go(const FrameMotion& end);

  const SolverInfo info_;
  const double collision_margin_m_;
  const double voxel_m_;
  int substeps_ = 0;
  const Scene* scene_ = nullptr;
  std::unique_ptr<ColliderBodies> colliders_;
  FrameMotion now_;                  ///< at the end of the last frame; empty in a static scene
  std::vector<btScalar> free_mass_;  ///< masses of all vertices, also of attached ones; 0 if pinned
};

SolverEntry soft_entry();
SolverEntry deformable_entry();

}  // namespace clothbench::bullet_baseline
