#include "nvcloth/solver.hpp"

#include <foundation/PxAllocatorCallback.h>
#include <foundation/PxErrorCallback.h>

#include <cstdlib>
#include <stdexcept>

namespace clothbench::nvcloth {
namespace {

using physx::PxVec3;
using physx::PxVec4;

struct Memory : physx::PxAllocatorCallback {
  void* allocate(std::size_t size, const char*, const char*, int) override {
    return std::aligned_alloc(16, (size + 15) / 16 * 16);
  }
  void deallocate(void* at) override { std::free(at); }
};

struct Messages : physx::PxErrorCallback {
  std::string last;
  void reportError(physx::PxErrorCode::Enum, const char* message, const char*, int) override { last = message; }
};

struct Asserts : nv::cloth::PxAssertHandler {
  void operator()(const char*, const char*, int, bool& ignore) override { ignore = true; }
};

Messages& messages() {
  static Messages all;
  return all;
}

/// Farther than a cloth reaches [cm]: a radius within which a motion constraint leaves its particle free.
constexpr float kFree = 1e7F;

std::vector<double> inverse_masses(const ClothbenchScene& s) {
  std::vector<double> out;
  for (std::uint32_t v = 0; v < s.vertex_count; ++v) out.push_back(1 / s.mass_kg[v]);
  for (std::uint32_t k = 0; k < s.pin_count; ++k) out[s.pins[k]] = 0;
  return out;
}

}  // namespace

void start_engine() {
  static Memory memory;
  static Asserts asserts;
  static const bool once = (nv::cloth::InitializeNvCloth(&memory, &messages(), &asserts, nullptr), true);
  (void)once;
}

void require(const void* made, const char* what) {
  if (made == nullptr) throw std::runtime_error(std::string("NvCloth: ") + what + " failed: " + messages().last);
}

Settings::Settings(const double* v)
    : solver_frequency_hz(v[0]),
      substeps(v[1]),
      stiffness_frequency_hz(v[2]),
      tethers(v[3]),
      virtual_particles(v[4]),
      continuous_collision(v[5]),
      collision_margin_m(v[6]),
      frictionless_triangles(v[7]),
      cuda(v[8]) {}

double Settings::frequency_hz(double frame_rate_hz) const {
  return substeps > 0 ? substeps * frame_rate_hz : solver_frequency_hz;
}

int Settings::iterations(double dt_s) const {
  const double n = substeps > 0 ? substeps : std::floor(dt_s * solver_frequency_hz + 0.5);
  return static_cast<int>(std::max(1.0, n));
}

std::string obstacle(const Settings& settings, const ClothbenchScene& s) {
  if (settings.cuda > 0)
    return std::string("not built: ") + (NvClothCompiledWithCudaSupport()
                                             ? "this adapter has no path to NvCloth on CUDA"
                                             : "the engine was compiled without CUDA");
  const std::vector<double> w = inverse_masses(s);
  if (std::all_of(w.begin(), w.end(), [](double x) { return x == 0; }))
    return "NvCloth's cooker makes no fabric where every vertex is pinned";
  if (s.vertex_count > 65000) return "NvCloth numbers particles with 16 bits, so a cloth has at most 65000 vertices";
  for (std::uint32_t k = 0; k < s.collider_count && !(settings.frictionless_triangles > 0); ++k)
    if (s.colliders[k].shape == CLOTHBENCH_SHAPE_MESH && s.colliders[k].friction > 0)
      return "NvCloth's collision with triangles has no friction (solver.frictionless_triangles=1 runs it without)";
  return Colliders::obstacle(s);
}

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
  FabricOptions options;
  options.tethers = settings.tethers > 0;
  options.iteration_s = iteration_s_;
  options.stiffness_frequency_hz =
      settings.stiffness_frequency_hz > 0 ? settings.stiffness_frequency_hz : 1 / iteration_s_;
  cooked_ = cook(*factory_, s, inverse_mass_, options);
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
  if (colliders_.has_spheres() && settings_.virtual_particles > 0) add_virtual_particles();
  solver_->addCloth(cloth_);
}

void Solver::set_constants() {
  const double frequency = settings_.stiffness_frequency_hz > 0 ? settings_.stiffness_frequency_hz : 1 / iteration_s_;
  const double* g = scene_.gravity_m_per_s2;
  cloth_->setSolverFrequency(static_cast<float>(settings_.frequency_hz(scene_.frame_rate_hz)));
  cloth_->setStiffnessFrequency(static_cast<float>(frequency));
  cloth_->setGravity(PxVec3(static_cast<float>(g[0] * kPerMetre), static_cast<float>(g[1] * kPerMetre),
                            static_cast<float>(g[2] * kPerMetre)));
  // The share of the velocity that is lost in 1 / frequency seconds.
  cloth_->setDamping(PxVec3(static_cast<float>(-std::expm1(-scene_.damping_per_s / frequency))));
  cloth_->setPhaseConfig(range(cooked_.phases));
  cloth_->setFriction(static_cast<float>(peer::needs(scene_, CLOTHBENCH_FRICTION) ? colliders_.friction() : 0));
  cloth_->enableContinuousCollision(colliders_.has_spheres() && settings_.continuous_collision > 0);
}

/// One at the middle of each triangle. The engine tests them against spheres and capsules alone.
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

}  // namespace clothbench::nvcloth
