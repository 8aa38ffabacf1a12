// NvCloth on the CPU behind clothbench_plugin.h.
#include "nvcloth/scene.hpp"

namespace clothbench::nvcloth {

std::string obstacle(const Settings& settings, const ClothbenchScene& s) {
  const std::vector<double> w = inverse_masses(s);
  if (std::all_of(w.begin(), w.end(), [](double x) { return x == 0; }))
    return "NvCloth's cooker makes no fabric where every vertex is pinned";
  if (s.vertex_count > 65000) return "NvCloth numbers particles with 16 bits, so a cloth has at most 65000 vertices";
  for (std::uint32_t k = 0; k < s.collider_count && !(settings.frictionless_triangles > 0); ++k)
    if (s.colliders[k].shape == CLOTHBENCH_SHAPE_MESH && s.colliders[k].friction > 0)
      return "NvCloth's collision with triangles has no friction (solver.frictionless_triangles=1 runs it without)";
  return shape_obstacle(s);
}

class Solver {
 public:
  /// Throws std::runtime_error with the reason if the engine cannot run the scene.
  Solver(const Settings&, const ClothbenchScene&);
  ~Solver();
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  void reset();
  void restart(const ClothbenchRestart&);
  std::int32_t step(const ClothbenchFrame&);
  void read(double* position_m, double* velocity_m_per_s) const;
  double margin_m(std::uint32_t collider) const;

  ClothbenchStage stage;

 private:
  void make_cloth(const double* position_m, const double* velocity_m_per_s);
  void drop_cloth();
  void set_constants();
  void add_virtual_particles();
  /// Positions [m] of the grips and whether each is held; null: where the scene starts, all of them.
  void hold(const double* position_m, const std::uint8_t* held);

  const ClothbenchScene& scene_;
  Settings settings_;
  peer::Point origin_;
  double iteration_s_;
  std::vector<double> inverse_mass_;  ///< [1/kg], 0 where pinned
  Colliders colliders_;
  nv::cloth::Factory* factory_ = nullptr;
  nv::cloth::Solver* solver_ = nullptr;
  nv::cloth::Cloth* cloth_ = nullptr;
  Cooked cooked_;
};

Solver::Solver(const Settings& settings, const ClothbenchScene& s)
    : stage(peer::whole_step("simulate", s)),
      scene_(s),
      settings_(settings),
      origin_(peer::centre(s)),
      iteration_s_(1 / s.frame_rate_hz / settings.iterations(1 / s.frame_rate_hz)),
      inverse_mass_(inverse_masses(s)),
      colliders_(s, origin_, settings.collision_margin_m) {
  if (const std::string why = obstacle(settings, s); !why.empty()) throw std::runtime_error(why);
  start_engine();
  factory_ = NvClothCreateFactoryCPU();
  require(factory_, "NvClothCreateFactoryCPU");
  cooked_ = cook(*factory_, s, inverse_mass_, settings.tethers > 0, iteration_s_);
  solver_ = factory_->createSolver();
  reset();
}

Solver::~Solver() {
  drop_cloth();
  NV_CLOTH_DELETE(solver_);
  cooked_.fabric->decRefCount();
  NvClothDestroyFactory(factory_);
}

void Solver::drop_cloth() {
  if (cloth_ == nullptr) return;
  solver_->removeCloth(cloth_);
  NV_CLOTH_DELETE(cloth_);
  cloth_ = nullptr;
}

/// Velocities are differences of positions there: the previous ones lie an iteration back.
void Solver::make_cloth(const double* position_m, const double* velocity_m_per_s) {
  drop_cloth();
  std::vector<PxVec4> now;
  for (std::uint32_t v = 0; v < scene_.vertex_count; ++v)
    now.push_back(to_engine(peer::point(position_m, v), origin_, inverse_mass_[v]));
  cloth_ = factory_->createCloth(range(now), *cooked_.fabric);
  require(cloth_, "Factory::createCloth");
  nv::cloth::MappedRange<PxVec4> before = cloth_->getPreviousParticles();
  for (std::uint32_t v = 0; v < scene_.vertex_count; ++v) {
    if (!(inverse_mass_[v] > 0)) continue;
    peer::Point x = peer::point(position_m, v);
    for (std::size_t k = 0; k < 3; ++k) x[k] -= velocity_m_per_s[3 * v + k] * iteration_s_;
    before[v] = to_engine(x, origin_, inverse_mass_[v]);
  }
  set_constants();
  colliders_.place(*cloth_);
  if (colliders_.has_spheres()) add_virtual_particles();
  solver_->addCloth(cloth_);
}

void Solver::set_constants() {
  const double frequency = 1 / iteration_s_;
  const double* g = scene_.gravity_m_per_s2;
  cloth_->setSolverFrequency(static_cast<float>(settings_.frequency_hz(scene_.frame_rate_hz)));
  cloth_->setStiffnessFrequency(static_cast<float>(frequency));
  cloth_->setGravity(PxVec3(static_cast<float>(g[0] * kPerMetre), static_cast<float>(g[1] * kPerMetre),
                            static_cast<float>(g[2] * kPerMetre)));
  // The share of the velocity that is lost in 1 / frequency seconds.
  cloth_->setDamping(PxVec3(static_cast<float>(-std::expm1(-scene_.damping_per_s / frequency))));
  cloth_->setPhaseConfig(range(cooked_.phases));
  cloth_->setFriction(static_cast<float>(peer::needs(scene_, CLOTHBENCH_FRICTION) ? colliders_.friction() : 0));
  cloth_->enableContinuousCollision(colliders_.has_spheres());
}

/// One at the middle of each triangle. The engine tests them only against spheres and capsules.
void Solver::add_virtual_particles() {
  std::vector<std::array<std::uint32_t, 4>> particles;
  for (std::uint32_t t = 0; t < scene_.triangle_count; ++t) {
    const std::uint32_t* v = scene_.triangles + 3 * t;
    particles.push_back({v[0], v[1], v[2], 0});
  }
  const std::vector<PxVec3> weights = {PxVec3(1.0F / 3)};
  using Indices = const std::uint32_t[4];
  auto* first = reinterpret_cast<Indices*>(particles.data());
  cloth_->setVirtualParticles(nv::cloth::Range<Indices>(first, first + particles.size()), range(weights));
}

/// Motion constraints of radius 0, which the engine interpolates over the frame's iterations.
void Solver::hold(const double* position_m, const std::uint8_t* held) {
  if (scene_.grip_count == 0) return;
  const nv::cloth::Range<PxVec4> spheres = cloth_->getMotionConstraints();
  std::fill(spheres.begin(), spheres.end(), PxVec4(0, 0, 0, kFree));
  for (std::uint32_t k = 0; k < scene_.grip_count; ++k) {
    const std::uint32_t v = scene_.grips[k];
    if (held != nullptr && held[k] == 0) continue;
    const peer::Point at = position_m != nullptr ? peer::point(position_m, k) : peer::point(scene_.position_m, v);
    spheres[v] = to_engine(at, origin_, 0);
  }
}

void Solver::reset() {
  colliders_.put(scene_.poses);
  make_cloth(scene_.position_m, scene_.velocity_m_per_s);
  hold(nullptr, nullptr);
}

void Solver::restart(const ClothbenchRestart& at) {
  colliders_.put(at.poses);
  make_cloth(at.position_m, at.velocity_m_per_s);
  hold(at.grip_position_m, at.grip_held);
}

std::int32_t Solver::step(const ClothbenchFrame& frame) {
  hold(frame.grip_position_m, frame.grip_held);
  if (frame.grip_teleports != nullptr) cloth_->clearInterpolation();
  colliders_.move(*cloth_, frame);
  iteration_s_ = frame.dt_s / settings_.iterations(frame.dt_s);
  if (settings_.substeps > 0) cloth_->setSolverFrequency(static_cast<float>(settings_.substeps / frame.dt_s));
  solver_->beginSimulation(static_cast<float>(frame.dt_s));
  for (int chunk = 0; chunk < solver_->getSimulationChunkCount(); ++chunk) solver_->simulateChunk(chunk);
  solver_->endSimulation();
  const nv::cloth::MappedRange<const PxVec4> x = nv::cloth::readCurrentParticles(*cloth_);
  for (std::uint32_t v = 0; v < scene_.vertex_count; ++v)
    if (!std::isfinite(x[v].x + x[v].y + x[v].z)) return CLOTHBENCH_NOT_FINITE;
  return CLOTHBENCH_OK;
}

void Solver::read(double* position_m, double* velocity_m_per_s) const {
  const nv::cloth::Cloth& cloth = *cloth_;
  const auto now = cloth.getCurrentParticles(), before = cloth.getPreviousParticles();
  for (std::uint32_t v = 0; v < scene_.vertex_count; ++v)
    for (unsigned k = 0; k < 3; ++k) {
      const double x = static_cast<double>(now[v][k]), last = static_cast<double>(before[v][k]);
      position_m[3 * v + k] = origin_[k] + x / kPerMetre;
      velocity_m_per_s[3 * v + k] = inverse_mass_[v] > 0 ? (x - last) / kPerMetre / iteration_s_ : 0;
    }
}

double Solver::margin_m(std::uint32_t collider) const {
  return peer::margin(settings_.collision_margin_m, scene_.colliders[collider]);
}

namespace {

/// The engine's integrator: v += (v e^(-c h) - v) + g h, x += h v.
double free_fall_m(const double* values, double dt_s, double gravity, double velocity, double damping,
                   std::int32_t frames) {
  const int n = Settings(values).iterations(dt_s);
  const double h = dt_s / n, kept = std::exp(-damping * h);
  return peer::fallen_m(std::int64_t{frames} * n, h, velocity, [=](double v) { return kept * v + h * gravity; });
}

const ClothbenchSetting kSettings[] = {
    {"solver_frequency_hz", "solver iterations per second (setSolverFrequency)", 300, 0},
    {"substeps", "solver iterations per frame, in place of the solver frequency; 0: by the frequency", 0, 1},
    {"tethers", "1: geodesic tethers to the pins", 1, 1},
    {"collision_margin_m", "distance at which colliders hold the cloth; 0: the scene's margins", 0, 0},
    {"frictionless_triangles", "1: run scenes whose meshes have friction, without it; 0: refuse them", 0, 1}};

}  // namespace
}  // namespace clothbench::nvcloth

namespace adapter = clothbench::nvcloth;

extern "C" const ClothbenchPlugin* clothbench_plugin(void) {
  static const ClothbenchPlugin plugin = clothbench::peer::plugin<adapter::Solver, adapter::Settings>(
      {"nvcloth", "NvCloth", "NvCloth 1.1.6 on one CPU core (SSE2), in centimetres", "1", adapter::free_fall_m},
      adapter::kSettings);
  return &plugin;
}
