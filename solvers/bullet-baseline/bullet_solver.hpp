#pragma once
#include <BulletSoftBody/btSoftBody.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "bullet-baseline/collider_bodies.hpp"
#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"

namespace clothbench::bullet_baseline {

/// What both solvers of this folder have in common; name, summary and settings are theirs.
SolverInfo common_info();

SettingSpec collision_margin_spec();
SettingSpec mesh_spec();
SettingSpec voxel_spec();

/// Share of its velocity a node keeps in a step of h [s]: e^(-c h), and 1 without damping.
double kept_share(const Scene&, double h);

/// The setting as an integer; throws Error outside [least, most].
int integer_setting(const SolverInfo&, const nlohmann::json& settings, const char* name, int least, int most);
/// The same for a number in (least, most].
double number_setting(const SolverInfo&, const nlohmann::json& settings, const char* name, double least, double most);

/// A grid cloth as a btSoftBody, the colliders as rigid bodies and the held vertices: the half that does not depend on
/// which of Bullet's two solvers moves the cloth.
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
  /// A new world, if the scene takes one, and in it a new body made by new_body().
  virtual void build() = 0;
  /// The body leaves the world, which then goes.
  virtual void tear_down() = 0;
  virtual void substep(btScalar h) = 0;
  /// After a vertex changed between held and free.
  virtual void masses_changed() = 0;

  /// The world a collider's rigid body goes into; null where the scene has none.
  virtual btDiscreteDynamicsWorld* world() = 0;

  /// Nodes at the scene's positions, mass 0 (Bullet's sign for "does not move") for what is pinned or held;
  /// nothing that Bullet adds by default, and collisions off.
  std::unique_ptr<btSoftBody> new_body(btSoftBodyWorldInfo&);
  /// Links of one kind, their rest lengths from the scene: Bullet would take the distances at the start.
  static void add_links(btSoftBody&, const Cloth&, EdgeKind);
  /// Gravity, no air, no water, voxels of the distance fields.
  void set_surroundings(btSoftBodyWorldInfo&) const;
  /// For the destructors of the two solvers.
  void drop();

  const Scene& scene() const { return *scene_; }
  bool touches() const { return !scene_->colliders.empty(); }
  double contact_margin_m() const;

  std::unique_ptr<btSoftBody> body_;

 private:
  /// Held vertices at `share` of the way from the last frame's end to this one's.
  void hold(const FrameMotion& end, double share, btScalar h);
  void let_go(const FrameMotion& end);

  const SolverInfo info_;
  const double collision_margin_m_;
  const MeshAs mesh_;
  const double voxel_m_;
  int substeps_ = 0;
  const Scene* scene_ = nullptr;
  std::unique_ptr<ColliderBodies> colliders_;
  FrameMotion now_;                  ///< at the end of the last frame; empty where nothing moves
  std::vector<btScalar> free_mass_;  ///< of all vertices, held ones too
};

SolverEntry soft_entry();
SolverEntry deformable_entry();

}  // namespace clothbench::bullet_baseline
