// Bullet's force-based deformable body: btDeformableMultiBodyDynamicsWorld with springs in N/m.
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableMassSpringForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bullet-baseline/bullet_solver.hpp"

namespace clothbench::bullet_baseline {
namespace {

/// Vector from a link's first end to its second, at the positions where Bullet evaluates forces.
btVector3 reach(const btSoftBody::Link& l) { return l.m_n[1]->m_q - l.m_n[0]->m_q; }

/// btDeformableMassSpringForce with a stiffness for each link. Bullet's class has only two stiffnesses. An isotropic
/// grid needs one along each direction, half of each on the borders, one on the diagonals and one for bending.
///
/// The energy is Bullet's, k/2 (|d| - r)^2. Its second derivative is exact, hence indefinite if a link is compressed.
/// This class has no damping: Bullet's acts on motion relative to neighbours, a scene's on all motion.
class GridSprings final : public btDeformableMassSpringForce {
 public:
  /// Stiffness [N/m] of each link of the only body to which this force is added.
  explicit GridSprings(std::vector<btScalar> stiffness) : stiffness_(std::move(stiffness)) {}

  void addScaledElasticForce(btScalar scale, TVStack& force) override {
    for (int i = 0; i < body().m_links.size(); ++i) {
      const btSoftBody::Link& l = body().m_links[i];
      const btVector3 d = reach(l);
      const btScalar length = d.length();
      if (!(length > SIMD_EPSILON)) continue;  // the force has no direction
      const btVector3 pull = d * (scale * stiffness_[static_cast<std::size_t>(i)] * (1 - l.m_rl / length));
      force[l.m_n[0]->index] += pull;
      force[l.m_n[1]->index] -= pull;
    }
  }

  void addScaledElasticForceDifferential(btScalar scale, const TVStack& dx, TVStack& df) override {
    for (int i = 0; i < body().m_links.size(); ++i) {
      const btSoftBody::Link& l = body().m_links[i];
      const btVector3 d = reach(l);
      const btScalar length = d.length();
      if (!(length > SIMD_EPSILON)) continue;
      // dF = k (n n^T + (1 - r/|d|) (1 - n n^T)) (dx_1 - dx_0)
      const btVector3 n = d / length, apart = dx[l.m_n[1]->index] - dx[l.m_n[0]->index];
      const btScalar along = n.dot(apart), slack = l.m_rl / length;
      const btVector3 change =
          (apart * (1 - slack) + n * (along * slack)) * (scale * stiffness_[static_cast<std::size_t>(i)]);
      df[l.m_n[0]->index] += change;
      df[l.m_n[1]->index] -= change;
    }
  }

  double totalElasticEnergy(btScalar) override {
    double energy = 0;
    for (int i = 0; i < body().m_links.size(); ++i) {
      const btSoftBody::Link& l = body().m_links[i];
      const double longer = static_cast<double>(reach(l).length() - l.m_rl);
      energy += 0.5 * static_cast<double>(stiffness_[static_cast<std::size_t>(i)]) * longer * longer;
    }
    return energy;
  }

  void addScaledDampingForce(btScalar, TVStack&) override {}
  void addScaledDampingForceDifferential(btScalar, const TVStack&, TVStack&) override {}
  void buildDampingForceDifferentialDiagonal(btScalar, TVStack&) override {}

 private:
  const btSoftBody& body() { return *m_softBodies[0]; }

  const std::vector<btScalar> stiffness_;
};

SolverInfo deformable_info() {
  SolverInfo info =
      bullet_info("bullet-deformable",
                  "Bullet's deformable body with springs in N/m (btDeformableMultiBodyDynamicsWorld) on one CPU core",
                  {{"substeps", "0",
                    "substeps per frame; 0: 4 if implicit, otherwise the fewest that keep the stiffest vertex stable"},
                   {"implicit", "false",
                    "backward Euler (one Newton step, conjugate gradients, projection); blows up on contact"}});
  info.supports.add(Feature::Regions);
  return info;
}

struct DeformableWorld {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btDeformableBodySolver cloth_solver;
  btDeformableMultiBodyConstraintSolver contact_solver;
  btDeformableMultiBodyDynamicsWorld world{&dispatcher, &broadphase, &contact_solver, &configuration, &cloth_solver};

  DeformableWorld() { contact_solver.setDeformableSolver(&cloth_solver); }
};

/// Stiffness of a link [N/m].
double link_stiffness(const Scene& s, const Edge& e) {
  // Approximates inextensible cloth. The number of explicit substeps grows with the square root of this stiffness.
  constexpr double kStiff_N_per_m = 1e4;
  if (e.kind != EdgeKind::SkipOne) return spring_N_per_m(s, e, membrane_stiffness(s, e).value_or(kStiff_N_per_m));
  const auto [own, other] = edge_cell(s.cloth, e);
  const double cell = own / 2;
  return s.material.bending_rigidity_N_m * other / (cell * cell * cell) * (on_border(s.cloth, e) ? 0.5 : 1);
}

constexpr EdgeKind kKinds[] = {EdgeKind::Structural, EdgeKind::Shear, EdgeKind::SkipOne};

bool linked(const Scene& scene, EdgeKind kind) {
  if (kind == EdgeKind::Shear) return scene.needs.has(Feature::Shear);
  return kind != EdgeKind::SkipOne || scene.needs.has(Feature::Bend);
}

/// stiffest_rad_per_s() of a mesh at its start. The largest eigenvalue of S_i is at most its Frobenius norm.
double stiffest_of_mesh_rad_per_s(const Scene& scene) {
  const std::vector<double> mass = vertex_masses(scene);
  const std::vector<Vec3>& x = scene.cloth.mesh->vertices;
  std::vector<std::array<double, 9>> sums(mass.size(), std::array<double, 9>{});
  for (const Edge& e : edges(scene.cloth, EdgeKind::Structural)) {
    const Vec3 along = minus(x[e.b], x[e.a]);
    const double k = link_stiffness(scene, e) / dot(along, along);
    for (std::uint32_t i : {e.a, e.b})
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) sums[i][3 * r + c] += k * along[r] * along[c];
  }
  double most = 0;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    double square = 0;
    for (const double s : sums[i]) square += s * s;
    most = std::max(most, std::sqrt(square) / mass[i]);
  }
  return std::sqrt(2 * most);
}

/// Upper bound of the flat sheet's highest angular frequency [rad/s].
///
/// In a mass-spring system sum k (n.(x_i - x_j))^2 <= 2 sum_i x_i.S_i x_i with S_i = sum k n n^T over the links of
/// vertex i, hence omega^2 <= 2 max_i lambda_max(S_i)/m_i.
double stiffest_rad_per_s(const Scene& scene) {
  if (scene.cloth.mesh) return stiffest_of_mesh_rad_per_s(scene);
  const std::vector<double> mass = vertex_masses(scene);
  const double b = scene.cloth.dv();
  const auto columns = static_cast<std::uint32_t>(scene.cloth.columns);
  const auto line_u = [&](std::uint32_t v) { return scene.cloth.line_u_m(static_cast<int>(v % columns)); };
  std::vector<std::array<double, 3>> sums(mass.size(), {0, 0, 0});  // S_uu, S_uv, S_vv
  for (EdgeKind kind : kKinds) {
    if (!linked(scene, kind)) continue;
    for (const Edge& e : edges(scene.cloth, kind)) {
      const double u = line_u(e.b) - line_u(e.a);
      const double v = b * (static_cast<double>(e.b / columns) - static_cast<double>(e.a / columns));
      const double k = link_stiffness(scene, e) / (u * u + v * v);
      for (std::uint32_t i : {e.a, e.b}) {
        sums[i][0] += k * u * u;
        sums[i][1] += k * u * v;
        sums[i][2] += k * v * v;
      }
    }
  }
  double most = 0;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    const auto& [uu, uv, vv] = sums[i];
    most = std::max(most, ((uu + vv) / 2 + std::hypot((uu - vv) / 2, uv)) / mass[i]);
  }
  return std::sqrt(2 * most);
}

int substeps_of(const Scene& scene, const nlohmann::json& settings) {
  const int asked = settings["substeps"].get<int>();
  if (asked > 0) return asked;
  if (settings["implicit"].get<bool>()) return 4;
  // Semi-implicit Euler is stable for steps below 2/omega; a fifth is a reserve for stretched cloth.
  return std::max(1, static_cast<int>(std::ceil(scene.time.dt() * stiffest_rad_per_s(scene) / (2 * 0.8))));
}

class BulletDeformable final : public BulletSolver {
 public:
  explicit BulletDeformable(const nlohmann::json& s)
      : BulletSolver(deformable_info(), s), settings_(s), implicit_(s["implicit"].get<bool>()) {
    integer_setting(info(), s, "substeps", 0, 4096);
  }
  ~BulletDeformable() override { drop(); }

 private:
  int substeps_for(const Scene& scene) const override { return substeps_of(scene, settings_); }

  void build() override {
    parts_ = std::make_unique<DeformableWorld>();
    btDeformableMultiBodyDynamicsWorld& w = parts_->world;
    set_surroundings(w.getWorldInfo());
    const btVector3 gravity = to_bullet(scene().gravity_m_per_s2);
    w.setGravity(gravity);
    w.setImplicit(implicit_);
    // Without projection implicit steps do not move the cloth: Bullet's other preconditioner ignores such steps.
    w.setUseProjection(true);
    body_ = new_body(w.getWorldInfo());
    std::vector<btScalar> stiffness;
    for (EdgeKind kind : kKinds) {
      if (!linked(scene(), kind)) continue;
      add_links(*body_, scene().cloth, kind);
      for (const Edge& e : edges(scene().cloth, kind))
        stiffness.push_back(static_cast<btScalar>(link_stiffness(scene(), e)));
    }
    // Only nodes collide with rigid bodies: PyBullet's face contacts make this cloth jump, at three times the cost.
    if (touches()) body_->m_cfg.collisions = btSoftBody::fCollision::SDF_RD | btSoftBody::fCollision::SDF_RDN;
    w.addSoftBody(body_.get());
    springs_ = std::make_unique<GridSprings>(std::move(stiffness));
    gravity_ = std::make_unique<btDeformableGravityForce>(gravity);
    w.addForce(body_.get(), springs_.get());
    w.addForce(body_.get(), gravity_.get());
  }

  void tear_down() override {
    if (parts_ && body_) parts_->world.removeSoftBody(body_.get());
    parts_.reset();
  }

  btDiscreteDynamicsWorld* world() override { return &parts_->world; }

  void substep(btScalar h) override {
    if (scene().needs.has(Feature::Damping)) {
      // Bullet's own drag is lost in implicit steps.
      const auto keep = static_cast<btScalar>(kept_share(scene(), static_cast<double>(h)));
      for (int i = 0; i < body_->m_nodes.size(); ++i) {
        btSoftBody::Node& n = body_->m_nodes[i];
        if (n.m_im > 0) n.m_v = n.m_vn = n.m_v * keep;
      }
    }
    parts_->world.stepSimulation(h, 0);
  }

  void masses_changed() override {}  // Bullet reads masses in every step

  const nlohmann::json settings_;
  const bool implicit_;
  std::unique_ptr<DeformableWorld> parts_;
  std::unique_ptr<GridSprings> springs_;
  std::unique_ptr<btDeformableGravityForce> gravity_;
};

/// Every substep: v <- e^(-c h) v + g h, x <- x + h v.
double deformable_free_fall_m(const Scene& scene, const nlohmann::json& settings, int frames) {
  const int substeps = substeps_of(scene, settings);
  const double h = scene.time.dt() / substeps, g = scene.gravity_m_per_s2[1], keep = kept_share(scene, h);
  double v = scene.cloth.initial_velocity_m_per_s[1], x = 0;
  for (long i = 0; i < static_cast<long>(frames) * substeps; ++i) {
    v = keep * v + g * h;
    x += v * h;
  }
  return x;
}

}  // namespace

SolverEntry deformable_entry() {
  return {deformable_info(),
          [](const nlohmann::json& s, const DeviceOptions&) { return std::make_unique<BulletDeformable>(s); },
          deformable_free_fall_m};
}

}  // namespace clothbench::bullet_baseline
