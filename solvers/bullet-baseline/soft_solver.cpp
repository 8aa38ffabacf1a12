// Bullet's position-based soft body (btSoftBody) as a cloth: the CPU baseline that stands in for Unity Cloth.
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include "bullet-baseline/bullet_solver.hpp"

namespace clothbench::bullet_baseline {
namespace {

SolverInfo soft_info() {
  return bullet_info(
      "bullet-soft", "Bullet's position-based soft body (btSoftBody) on one CPU core",
      {{"iterations", "10", "position iterations per substep (piterations)"},
       {"substeps", "4", "substeps per frame"},
       {"relaxation", "1.0", "kLST: fraction of a link's error removed per iteration, 0 to 1; not a stiffness"}});
}

/// The objects of a Bullet world with rigid bodies; members in the order of construction.
struct SoftWorld {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver rigid_solver;
  btSoftRigidDynamicsWorld world{&dispatcher, &broadphase, &rigid_solver, &configuration};
};

class BulletSoft final : public BulletSolver {
 public:
  explicit BulletSoft(const nlohmann::json& s)
      : BulletSolver(soft_info(), s),
        iterations_(integer_setting(info(), s, "iterations", 1, 100000)),
        substeps_(integer_setting(info(), s, "substeps", 1, 4096)),
        relaxation_(number_setting(info(), s, "relaxation", 0, 1)) {}
  ~BulletSoft() override { drop(); }

 private:
  int substeps_for(const Scene&) const override { return substeps_; }

  void build() override {
    if (touches())
      touching_ = std::make_unique<SoftWorld>();
    else
      alone_ = std::make_unique<btSoftBodyWorldInfo>();
    btSoftBodyWorldInfo& surroundings = touching_ ? touching_->world.getWorldInfo() : *alone_;
    set_surroundings(surroundings);
    body_ = new_body(surroundings);
    body_->m_cfg.piterations = iterations_;
    body_->m_materials[0]->m_kLST = static_cast<btScalar>(relaxation_);
    add_links(*body_, scene().cloth, EdgeKind::Structural);
    if (scene().needs.has(Feature::Shear)) add_links(*body_, scene().cloth, EdgeKind::Shear);
    if (scene().needs.has(Feature::Bend)) add_links(*body_, scene().cloth, EdgeKind::SkipOne);
    body_->updateLinkConstants();
    if (!touching_) return;
    body_->m_cfg.collisions = btSoftBody::fCollision::SDF_RS;
    // Otherwise nodes' boxes have Bullet's default margin of 0.25 m, and Bullet keeps a box until its node leaves it.
    body_->m_sst.radmrg = body_->getCollisionShape()->getMargin();
    body_->updateNodeTree(false, true);
    touching_->world.setGravity(to_bullet(scene().gravity_m_per_s2));
    touching_->world.addSoftBody(body_.get());
  }

  void tear_down() override {
    if (touching_ && body_) touching_->world.removeSoftBody(body_.get());
    touching_.reset();
    alone_.reset();
  }

  btDiscreteDynamicsWorld* world() override { return touching_ ? &touching_->world : nullptr; }

  void substep(btScalar h) override {
    body_->m_cfg.kDP = static_cast<btScalar>(1 - kept_share(scene(), static_cast<double>(h)));
    if (touching_) {
      touching_->world.stepSimulation(h, 0);
      return;
    }
    body_->predictMotion(h);
    body_->solveConstraints();
  }

  void masses_changed() override { body_->updateLinkConstants(); }

  const int iterations_, substeps_;
  const double relaxation_;
  std::unique_ptr<btSoftBodyWorldInfo> alone_;  ///< replaces the world in scenes without colliders
  std::unique_ptr<SoftWorld> touching_;
};

/// Every substep: v <- v + g h, x <- x + h v and, after the constraints, v <- (x - x_old)/h (1 - kDP).
double soft_free_fall_m(const Scene& scene, const nlohmann::json& settings, int frames) {
  const int substeps = settings["substeps"].get<int>();
  const double h = scene.time.dt() / substeps, g = scene.gravity_m_per_s2[1], keep = kept_share(scene, h);
  double v = scene.cloth.initial_velocity_m_per_s[1], x = 0;
  for (long i = 0; i < static_cast<long>(frames) * substeps; ++i) {
    v += g * h;
    x += v * h;
    v *= keep;
  }
  return x;
}

}  // namespace

SolverEntry soft_entry() {
  return {soft_info(), [](const nlohmann::json& s, const DeviceOptions&) { return std::make_unique<BulletSoft>(s); },
          soft_free_fall_m};
}

}  // namespace clothbench::bullet_baseline

namespace clothbench {

void register_bullet_baseline(std::vector<SolverEntry>& out) {
  out.push_back(bullet_baseline::soft_entry());
  out.push_back(bullet_baseline::deformable_entry());
}

}  // namespace clothbench
