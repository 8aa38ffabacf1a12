#pragma once
#include <BulletSoftBody/btSoftBody.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "bullet-baseline/collider_bodies.hpp"
#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"

namespace clothbench::bullet_baseline {

/// The part that both solvers of this folder share; each adds its own name, summary and settings.
SolverInfo common_info();

SettingSpec collision_margin_spec();
SettingSpec voxel_spec();

/// Share of its velocity that a node keeps in a step of h [s]: e^(-c h), or 1 without damping.
double kept_share(const Scene&, double h);

/// The setting as an integer; throws Error outside [least, most].
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
  /// Makes a new world, if the scene needs one, and a new body in it by new_body().
  virtual void build() = 0;
  /// Removes the body from the world, then destroys the world.
  virtual void tear_down() = 0;
  virtual void substep(btScalar h) = 0;
  /// Called after a vertex was attached or released.
  virtual void masses_changed() = 0;

  /// World of the colliders' rigid bodies; null where the scene has none.
  virtual btDiscreteDynamicsWorld* world() = 0;

  /// Makes a body with its nodes at the scene's positions. Pinned and attached nodes have mass 0, which marks a
  /// static node in Bullet. Everything that Bullet adds by default is off, collisions included.
  std::unique_ptr<btSoftBody> new_body(btSoftBodyWorldInfo&);
  /// Adds links of one kind with the scene's rest lengths; by default Bullet takes the distances at the start.
  static void add_links(btSoftBody&, const Cloth&, EdgeKind);
  /// Sets gravity, no air, no water, and the voxel size of the distance fields.
  void set_surroundings(btSoftBodyWorldInfo&) const;
  /// For the destructors of the two solvers.
  void drop();

  const Scene& scene() const { return *scene_; }
  bool touches() const { return !scene_->colliders.empty(); }
  double contact_margin_m() const;

  std::unique_ptr<btSoftBody> body_;

 private:
  /// Sets velocities that bring held vertices to `share` of the path from the last frame's end to this one's.
  void hold(const FrameMotion& end, double share, btScalar h);
  void let_go(const FrameMotion& end);

  const SolverInfo info_;
  const double collision_margin_m_;
  const double voxel_m_;
  int substeps_ = 0;
  const Scene* scene_ = nullptr;
  std::unique_ptr<ColliderBodies> colliders_;
  FrameMotion now_;                  ///< at the end of the last frame; empty in a static scene
  std::vector<btScalar> free_mass_;  ///< masses of all vertices, held ones too
};

SolverEntry soft_entry();
SolverEntry deformable_entry();

}  // namespace clothbench::bullet_baseline
