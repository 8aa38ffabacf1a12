// Bullet's position-based soft body (btSoftBody) as a cloth: the CPU baseline that stands in for Unity Cloth.
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyInternals.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {
namespace {

btVector3 bullet(const Vec3& v) { return {static_cast<btScalar>(v[0]), static_cast<btScalar>(v[1]), static_cast<btScalar>(v[2])}; }

/// Share of its velocity a node loses in a step of h: Bullet multiplies by 1 - kDP once a step.
double damping_share(const Scene& scene, double h) {
  return scene.needs.has(Feature::Damping) ? -std::expm1(-scene.material.damping_per_s * h) : 0;
}

SolverInfo describe() {
  SolverInfo info;
  info.name = "bullet-soft";
  info.folder = "solvers/bullet-baseline";
  info.summary = "Bullet's position-based soft body (btSoftBody) on one CPU core";
  info.version = "Bullet " + std::to_string(btGetVersion());
  info.precision = sizeof(btScalar) == 4 ? "float32" : "float64";
  info.supports = {Feature::Stretch, Feature::Shear, Feature::Bend, Feature::Damping, Feature::Pins};
  info.settings = {{"iterations", "10", "position iterations a substep (piterations)"},
                   {"substeps", "4", "substeps a frame"},
                   {"relaxation", "1.0", "kLST: share of a link's error removed in an iteration, 0 to 1; not a stiffness"}};
  return info;
}

class BulletSoft final : public ClothSolver {
 public:
  explicit BulletSoft(const nlohmann::json& s)
      : iterations_(s["iterations"].get<int>()), substeps_(s["substeps"].get<int>()), relaxation_(s["relaxation"].get<float>()) {
    if (!(iterations_ >= 1 && iterations_ <= 100000)) throw Error("solver bullet-soft: setting iterations: expected 1 to 100000; found " + s["iterations"].dump());
    if (!(substeps_ >= 1 && substeps_ <= 4096)) throw Error("solver bullet-soft: setting substeps: expected 1 to 4096; found " + s["substeps"].dump());
    if (!(relaxation_ > 0 && relaxation_ <= 1)) throw Error("solver bullet-soft: setting relaxation: expected more than 0, at most 1; found " + s["relaxation"].dump());
  }

  const SolverInfo& info() const override { return info_; }
  DeviceInfo device() const override { return {"CPU", "Bullet " + std::to_string(btGetVersion()), "C++", false, "{}"}; }

  void load(const Scene& scene) override {
    scene_ = &scene;
    reset();
  }

  void reset() override {
    world_ = std::make_unique<btSoftBodyWorldInfo>();
    world_->m_gravity = bullet(scene_->gravity_m_per_s2);
    world_->air_density = 0;
    world_->water_density = 0;
    const std::vector<double> start = initial_positions(*scene_);
    std::vector<double> mass = vertex_masses(*scene_);
    for (std::uint32_t v : scene_->pins.vertices) mass[v] = 0;  // Bullet's sign for "does not move"
    std::vector<btVector3> x;
    std::vector<btScalar> m;
    for (std::size_t v = 0; v < mass.size(); ++v) {
      x.push_back(bullet({start[3 * v], start[3 * v + 1], start[3 * v + 2]}));
      m.push_back(static_cast<btScalar>(mass[v]));
    }
    body_ = std::make_unique<btSoftBody>(world_.get(), static_cast<int>(x.size()), x.data(), m.data());
    configure();
    add_links(EdgeKind::Structural);
    add_links(EdgeKind::Shear);
    if (scene_->needs.has(Feature::Bend)) add_links(EdgeKind::SkipOne);
    const btVector3 v0 = bullet(scene_->cloth.initial_velocity_m_per_s);
    for (int i = 0; i < body_->m_nodes.size(); ++i)
      if (body_->m_nodes[i].m_im > 0) body_->m_nodes[i].m_v = v0;
  }

  StepStatus step(const FrameInput& frame) override {
    const auto h = static_cast<btScalar>(frame.dt_s / substeps_);
    body_->m_cfg.kDP = static_cast<btScalar>(damping_share(*scene_, frame.dt_s / substeps_));
    for (int s = 0; s < substeps_; ++s) {
      body_->predictMotion(h);
      body_->solveConstraints();
      body_->integrateMotion();
    }
    for (int i = 0; i < body_->m_nodes.size(); ++i)
      if (!std::isfinite(body_->m_nodes[i].m_x.length2())) return StepStatus::NotFinite;
    return StepStatus::Ok;
  }

  void read_state(ClothState& out) const override {
    out.position.clear();
    out.velocity.clear();
    for (int i = 0; i < body_->m_nodes.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        out.position.push_back(static_cast<double>(body_->m_nodes[i].m_x.m_floats[k]));
        out.velocity.push_back(static_cast<double>(body_->m_nodes[i].m_v.m_floats[k]));
      }
  }

  FrameCost last_cost() const override { return {kMissing, {kMissing}, {kMissing}, {kMissing}}; }

  Plan plan() const override {
    Plan p;
    // Bullet's substep is one piece of work: links of all kinds, damping and pins are served together.
    p.stages = {{"Step", scene_->needs & info_.supports, 0, kMissing, kMissing}};
    if (!scene_->needs.has(Feature::Bend)) p.left_out.push_back({"skip-one links", "the scene has no bending"});
    if ((scene_->needs & kColliderFeatures).empty()) p.left_out.push_back({"collision world", "the scene has no collider"});
    return p;
  }

 private:
  /// Everything that Bullet would otherwise add of its own is off.
  void configure() {
    btSoftBody::Config& c = body_->m_cfg;
    c.kVCF = 1;
    c.kDP = c.kDG = c.kLF = c.kPR = c.kVC = c.kDF = c.kMT = 0;
    c.piterations = iterations_;
    c.viterations = c.diterations = c.citerations = 0;
    c.collisions = 0;
    body_->m_materials[0]->m_kLST = relaxation_;
    body_->m_sst.sdt = static_cast<btScalar>(scene_->time.dt() / substeps_);
  }

  void add_links(EdgeKind kind) {
    for (const Edge& e : edges(scene_->cloth, kind)) {
      body_->appendLink(static_cast<int>(e.a), static_cast<int>(e.b), body_->m_materials[0]);
      btSoftBody::Link& link = body_->m_links[body_->m_links.size() - 1];
      link.m_bbending = kind == EdgeKind::SkipOne;
    }
  }

  const SolverInfo info_ = describe();
  const int iterations_, substeps_;
  const float relaxation_;
  const Scene* scene_ = nullptr;
  std::unique_ptr<btSoftBodyWorldInfo> world_;
  std::unique_ptr<btSoftBody> body_;
};

/// v <- v + g h, x <- x + h v, and v <- (x - x_old)/h (1 - kDP) after the constraints, every substep.
double free_fall_m(const Scene& scene, const nlohmann::json& settings, int frames) {
  const int substeps = settings["substeps"].get<int>();
  const double h = scene.time.dt() / substeps, g = scene.gravity_m_per_s2[1], keep = 1 - damping_share(scene, h);
  double v = scene.cloth.initial_velocity_m_per_s[1], x = 0;
  for (long i = 0; i < static_cast<long>(frames) * substeps; ++i) {
    v += g * h;
    x += v * h;
    v *= keep;
  }
  return x;
}

}  // namespace

void register_bullet_baseline(std::vector<SolverEntry>& out) {
  out.push_back({describe(), [](const nlohmann::json& s, const DeviceOptions&) { return std::make_unique<BulletSoft>(s); }, free_fall_m});
}

}  // namespace clothbench
