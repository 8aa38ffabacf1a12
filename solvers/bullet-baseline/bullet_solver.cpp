#include "bullet-baseline/bullet_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace clothbench::bullet_baseline {

SolverInfo bullet_info(const char* name, const char* summary, std::vector<SettingSpec> settings) {
  SolverInfo info;
  info.name = name;
  info.folder = "solvers/bullet-baseline";
  info.summary = summary;
  info.version = "Bullet " + std::to_string(btGetVersion());
  info.precision = sizeof(btScalar) == 4 ? "float32" : "float64";
  info.supports = {Feature::Stretch,  Feature::Shear,       Feature::Bend,       Feature::Damping,
                   Feature::Pins,     Feature::MovingPins,  Feature::Sphere,     Feature::Box,
                   Feature::Plane,    Feature::Capsules,    Feature::StaticMesh, Feature::MovingMesh,
                   Feature::Friction, Feature::DoubleSided, Feature::UnevenGrid, Feature::Spin,
                   Feature::ClothMesh};
  info.settings = std::move(settings);
  info.settings.push_back(
      {"collision_margin_m", "0.02", "contact offset [m]: PyBullet's default. 0: the scene's margin_m"});
  info.settings.push_back(
      {"sdf_voxel_m", "0.01", "voxel of the colliders' distance fields [m]; Bullet's own default is 0.25"});
  return info;
}

double kept_share(const Scene& scene, double h) {
  return scene.needs.has(Feature::Damping) ? std::exp(-scene.material.damping_per_s * h) : 1;
}

int integer_setting(const SolverInfo& info, const nlohmann::json& settings, const char* name, int least, int most) {
  const auto value = settings[name].get<long long>();
  if (!(value >= least && value <= most))
    throw Error("solver " + info.name + ": setting " + name + ": expected " + std::to_string(least) + " to " +
                std::to_string(most) + "; found " + dump(settings[name]));
  return static_cast<int>(value);
}

double number_setting(const SolverInfo& info, const nlohmann::json& settings, const char* name, double least,
                      double most) {
  const auto value = settings[name].get<double>();
  if (!(value > least && value <= most))
    throw Error("solver " + info.name + ": setting " + name + ": expected more than " + std::to_string(least) +
                ", at most " + std::to_string(most) + "; found " + dump(settings[name]));
  return value;
}

BulletSolver::BulletSolver(SolverInfo info, const nlohmann::json& settings)
    : info_(std::move(info)),
      collision_margin_m_(settings["collision_margin_m"].get<double>()),
      voxel_m_(number_setting(info_, settings, "sdf_voxel_m", 0, 1)) {
  if (!(collision_margin_m_ >= 0 && collision_margin_m_ <= 1))
    throw Error("solver " + info_.name + ": setting collision_margin_m: expected 0 to 1; found " +
                dump(settings["collision_margin_m"]));
}

DeviceInfo BulletSolver::device() const { return {"CPU", info_.version, "C++", false, "{}"}; }

void BulletSolver::load(const Scene& scene) {
  refuse_mesh_bending(scene);
  if (body_) drop();
  scene_ = &scene;
  substeps_ = substeps_for(scene);
  reset();
}

void BulletSolver::drop() {
  colliders_.reset();
  tear_down();
  body_.reset();
}

void BulletSolver::reset() {
  if (body_) drop();
  build();
  if (touches()) colliders_ = std::make_unique<ColliderBodies>(*scene_, *world());
  now_ = scene_->motion.empty() ? FrameMotion{} : scene_->motion.front();
}

void BulletSolver::set_surroundings(btSoftBodyWorldInfo& info) const {
  info.m_gravity = to_bullet(scene_->gravity_m_per_s2);
  info.air_density = 0;
  info.water_density = 0;
  if (!touches()) return;
  info.m_sparsesdf.setDefaultVoxelsz(static_cast<btScalar>(voxel_m_));
  info.m_sparsesdf.Reset();
}

double BulletSolver::contact_margin_m() const {
  if (collision_margin_m_ > 0) return collision_margin_m_;
  double widest = 0;
  for (const Collider& c : scene_->colliders) widest = std::max(widest, c.margin_m);
  return widest;
}

std::unique_ptr<btSoftBody> BulletSolver::new_body(btSoftBodyWorldInfo& info) {
  const std::vector<double> start = initial_positions(*scene_);
  const std::vector<double> mass = vertex_masses(*scene_);
  std::vector<btVector3> x;
  free_mass_.clear();
  for (std::size_t v = 0; v < mass.size(); ++v) {
    x.push_back(to_bullet(vertex_at(start, v)));
    free_mass_.push_back(static_cast<btScalar>(mass[v]));
  }
  for (std::uint32_t v : scene_->pins.vertices) free_mass_[v] = 0;
  std::vector<btScalar> m = free_mass_;
  for (std::uint32_t v : scene_->grips.vertices) m[v] = 0;
  auto made = std::make_unique<btSoftBody>(&info, static_cast<int>(x.size()), x.data(), m.data());
  btSoftBody::Config& c = made->m_cfg;
  c.kVCF = 1;
  c.kDP = c.kDG = c.kLF = c.kPR = c.kVC = c.kMT = 0;
  c.viterations = c.diterations = c.citerations = c.collisions = 0;
  // Hard contact, as in PyBullet: with Bullet's default of 0.1, a sweeping hand penetrates the cloth by 6 mm.
  c.kKHR = c.kCHR = 1;
  // Bullet multiplies the cloth's friction by the collider's, which is set to the pair's coefficient.
  c.kDF = 1;
  made->getCollisionShape()->setMargin(static_cast<btScalar>(contact_margin_m()));
  // Otherwise Bullet puts slow deformable bodies to sleep after 2 s, even in mid-air.
  made->setActivationState(DISABLE_DEACTIVATION);
  const std::vector<double> v = initial_velocities(*scene_);
  for (int i = 0; i < made->m_nodes.size(); ++i) {
    btSoftBody::Node& n = made->m_nodes[i];
    if (n.m_im > 0) n.m_v = n.m_vn = to_bullet(vertex_at(v, static_cast<std::size_t>(i)));
  }
  return made;
}

void BulletSolver::add_links(btSoftBody& body, const Cloth& cloth, EdgeKind kind) {
  for (const Edge& e : edges(cloth, kind)) {
    body.appendLink(static_cast<int>(e.a), static_cast<int>(e.b), body.m_materials[0]);
    btSoftBody::Link& link = body.m_links[body.m_links.size() - 1];
    link.m_bbending = kind == EdgeKind::SkipOne;
    link.m_rl = static_cast<btScalar>(e.rest_m);
    link.m_c1 = link.m_rl * link.m_rl;
  }
  // Otherwise Bullet's first step overwrites the rest lengths with distances of the positions.
  body.m_bUpdateRtCst = false;
}

StepStatus BulletSolver::step(const FrameInput& frame) {
  const auto h = static_cast<btScalar>(frame.dt_s / substeps_);
  for (int s = 1; s <= substeps_; ++s) {
    const double share = static_cast<double>(s) / substeps_;
    if (frame.motion != nullptr && colliders_) colliders_->move(now_, *frame.motion, share);
    if (frame.motion != nullptr) hold(*frame.motion, share, h);
    substep(h);
  }
  // Removes distance field cells that no node has used in 256 frames, because Bullet's list of cells only grows.
  if (colliders_) body_->getWorldInfo()->m_sparsesdf.GarbageCollect();
  if (frame.motion != nullptr) {
    let_go(*frame.motion);
    now_ = *frame.motion;
  }
  for (int i = 0; i < body_->m_nodes.size(); ++i)
    if (!std::isfinite(body_->m_nodes[i].m_x.length2())) return StepStatus::NotFinite;
  return StepStatus::Ok;
}

void BulletSolver::hold(const FrameMotion& end, double share, btScalar h) {
  const std::vector<std::uint32_t>& held = scene_->grips.vertices;
  for (std::size_t k = 0; k < held.size(); ++k) {
    btSoftBody::Node& n = body_->m_nodes[static_cast<int>(held[k])];
    if (now_.grip_held[k] == 0) continue;
    const btVector3 a = to_bullet(now_.grip_position_m[k]), b = to_bullet(end.grip_position_m[k]);
    // A node without mass moves at its velocity, which constraints do not change.
    n.m_v = n.m_vn = (a.lerp(b, static_cast<btScalar>(share)) - n.m_x) / h;
  }
}

void BulletSolver::let_go(const FrameMotion& end) {
  bool changed = false;
  for (std::size_t k = 0; k < scene_->grips.vertices.size(); ++k) {
    if (now_.grip_held[k] == 0 || end.grip_held[k] != 0) continue;
    const std::uint32_t v = scene_->grips.vertices[k];
    body_->m_nodes[static_cast<int>(v)].m_im = free_mass_[v] > 0 ? 1 / free_mass_[v] : 0;
    changed = true;
  }
  if (changed) masses_changed();
}

void BulletSolver::read_state(ClothState& out) const {
  out.position.clear();
  out.velocity.clear();
  for (int i = 0; i < body_->m_nodes.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      out.position.push_back(static_cast<double>(body_->m_nodes[i].m_x.m_floats[k]));
      out.velocity.push_back(static_cast<double>(body_->m_nodes[i].m_v.m_floats[k]));
    }
}

bool BulletSolver::restart(const ClothState& state) {
  if (!scene_->motion.empty()) return false;
  reset();
  for (int i = 0; i < body_->m_nodes.size(); ++i) {
    btSoftBody::Node& n = body_->m_nodes[i];
    n.m_x = n.m_q = to_bullet(vertex_at(state.position, static_cast<std::size_t>(i)));
    n.m_v = n.m_vn = to_bullet(vertex_at(state.velocity, static_cast<std::size_t>(i)));
  }
  return true;
}

FrameCost BulletSolver::last_cost() const {
  const std::vector<double> missing(plan().stages.size(), kMissing);
  return {kMissing, missing, missing, missing};
}

Plan BulletSolver::plan() const {
  constexpr FeatureSet kContact =
      kColliderFeatures | FeatureSet{Feature::Friction, Feature::DoubleSided, Feature::UnevenGrid, Feature::Spin};
  Plan p;
  // Bullet's step cannot be divided: one stage covers links of all kinds, damping, pins and attachments.
  p.stages = {{"Step", scene_->needs - kContact, 0, kMissing, kMissing}};
  if (!scene_->needs.has(Feature::Shear)) p.left_out.push_back({"diagonals", "the scene has no shear stiffness"});
  if (!scene_->needs.has(Feature::Bend)) p.left_out.push_back({"skip-one links", "the scene has no bending"});
  if (!touches()) {
    p.left_out.push_back({"rigid bodies and their distance fields", "the scene has no collider"});
    return p;
  }
  p.stages.push_back({"Contact", scene_->needs & kContact, 0, kMissing, kMissing});
  p.contact_margins_m.assign(scene_->colliders.size(), contact_margin_m());
  for (const Collider& c : scene_->colliders)
    if (c.margin_m != contact_margin_m())
      p.left_out.push_back({fmt::format("the scene's margin of {} m at {}", c.margin_m, c.name),
                            fmt::format("Bullet's contact offset is collision_margin_m = {} m", contact_margin_m())});
  return p;
}

}  // namespace clothbench::bullet_baseline
