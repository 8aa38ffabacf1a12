// NvCloth on the CPU behind clothbench_plugin.h.
#include <NvCloth/Callbacks.h>
#include <NvCloth/Fabric.h>
#include <NvCloth/Factory.h>
#include <NvCloth/Solver.h>
#include <NvClothExt/ClothFabricCooker.h>
#include <foundation/PxAllocatorCallback.h>
#include <foundation/PxErrorCallback.h>

#include "nvcloth/colliders.hpp"

namespace clothbench::nvcloth {
namespace {

constexpr float kFree = 1e7F;  // radius [cm] of a motion constraint that does not act

/// The engine's allocator, error callback and assertion handler in one object.
struct Callbacks : physx::PxAllocatorCallback, physx::PxErrorCallback, nv::cloth::PxAssertHandler {
  std::string message;
  void* allocate(std::size_t size, const char*, const char*, int) override {
    return std::aligned_alloc(16, (size + 15) / 16 * 16);
  }
  void deallocate(void* at) override { std::free(at); }
  void reportError(physx::PxErrorCode::Enum, const char* text, const char*, int) override { message = text; }
  void operator()(const char*, const char*, int, bool& ignore) override { ignore = true; }
};

Callbacks& engine() {
  static Callbacks all;
  static const bool once = (nv::cloth::InitializeNvCloth(&all, &all, &all, nullptr), true);
  (void)once;
  return all;
}

template <typename Made>
Made* require(Made* made, const char* what) {
  if (made == nullptr) throw std::runtime_error(std::string("NvCloth: ") + what + " failed: " + engine().message);
  return made;
}

struct Settings {
  double frequency_hz, substeps, tethers, margin_m, frictionless_triangles;
  explicit Settings(const double* v)
      : frequency_hz(v[0]), substeps(v[1]), tethers(v[2]), margin_m(v[3]), frictionless_triangles(v[4]) {}
  /// Solver iterations in a frame of `dt_s` seconds, rounded like the engine does.
  int iterations(double dt_s) const {
    const double n = substeps > 0 ? substeps : std::floor(dt_s * frequency_hz + 0.5);
    return static_cast<int>(std::max(1.0, n));
  }
};

template <typename T>
void describe(nv::cloth::BoundedData& to, const T* from, std::size_t count, std::size_t per_item = 1) {
  to.data = from;
  to.count = static_cast<physx::PxU32>(count);
  to.stride = static_cast<physx::PxU32>(per_item * sizeof(T));
}

/// Passes the sheet at rest to the cooker: quads of a grid, triangles of a mesh.
void cook_mesh(nv::cloth::ClothFabricCooker& cooker, const ClothbenchScene& s,
               const std::vector<double>& inverse_mass) {
  std::vector<PxVec3> points;
  for (const Point& p : peer::rest_points(s)) points.push_back(to_engine(p, 0).getXYZ());
  const std::vector<float> weights(inverse_mass.begin(), inverse_mass.end());
  std::vector<std::uint32_t> cells;
  for (std::uint32_t j = 0; j + 1 < s.rows; ++j)
    for (std::uint32_t i = 0; i + 1 < s.columns; ++i) {
      const std::uint32_t a = j * s.columns + i;
      cells.insert(cells.end(), {a, a + 1, a + 1 + s.columns, a + s.columns});
    }
  nv::cloth::ClothMeshDesc mesh;
  describe(mesh.points, points.data(), points.size());
  describe(mesh.invMasses, weights.data(), weights.size());
  if (cells.empty())
    describe(mesh.triangles, s.triangles, s.triangle_count, 3);
  else
    describe(mesh.quads, cells.data(), cells.size() / 4, 4);
  require(cooker.cook(mesh, PxVec3(0, 1, 0), true) ? &cooker : nullptr, "ClothFabricCooker::cook");
}

struct Cooked {
  nv::cloth::Fabric* fabric = nullptr;         ///< the caller owns one reference
  std::vector<nv::cloth::PhaseConfig> phases;  ///< phases that the scene needs, with their stiffness
};

/// Makes the fabric of the sheet at rest. `NvClothExt`'s cooker sorts constraints into phases: vertical and horizontal
/// edges, diagonals, and pairs two edges apart for bending; tethers lead to pins. Phases that no spring of the scene
/// needs are omitted. The stiffness of a constraint is the fraction of its error that one iteration removes, W k h^2 /
/// (1 + W k h^2), W: sum of inverse masses, k: spring stiffness. Each iteration here is a whole step of h, so this is
/// equivalent to compliance 1 / k (Macklin et al., XPBD, 2016, eq. 18 with lambda = 0).
Cooked cook(nv::cloth::Factory& factory, const ClothbenchScene& s, const std::vector<double>& inverse_mass,
            bool tethers, double iteration_s) {
  const auto free = [](nv::cloth::ClothFabricCooker* cooker) { NV_CLOTH_DELETE(cooker); };
  const std::unique_ptr<nv::cloth::ClothFabricCooker, decltype(free)> cooker(NvClothCreateFabricCooker(), free);
  cook_mesh(*cooker, s, inverse_mass);
  const nv::cloth::CookedData data = cooker->getCookedData();
  std::map<peer::Pair, double> stiffness;
  for (const peer::Spring& p : peer::springs(s)) stiffness[peer::pair(p.a, p.b)] = p.stiffness_N_per_m;
  const auto error_fraction = [&](std::uint32_t a, std::uint32_t b) {
    const auto spring = stiffness.find(peer::pair(a, b));
    if (spring == stiffness.end()) return 0.0;
    if (std::isinf(spring->second)) return 1.0;
    const double x = (inverse_mass[a] + inverse_mass[b]) * spring->second * iteration_s * iteration_s;
    return x / (1 + x);
  };
  Cooked out;
  std::vector<float> each(data.mRestvalues.size(), 0);  // log2 of the fraction of the error that one iteration leaves
  bool even = true;
  for (std::uint32_t phase = 0; phase < data.mPhaseIndices.size(); ++phase) {
    const std::uint32_t set = data.mPhaseIndices[phase];
    double low = 1, high = 0;
    for (std::uint32_t k = set == 0 ? 0 : data.mSets[set - 1]; k < data.mSets[set]; ++k) {
      const std::uint32_t a = data.mIndices[2 * k], b = data.mIndices[2 * k + 1];
      const double share = error_fraction(a, b);
      each[k] = static_cast<float>(std::max(std::log2(1 - share), -1e30));
      if (inverse_mass[a] > 0 && inverse_mass[b] > 0) low = std::min(low, share), high = std::max(high, share);
    }
    nv::cloth::PhaseConfig config(static_cast<std::uint16_t>(phase));
    config.mStiffness = static_cast<float>(high < low ? 1 : (low + high) / 2);
    even = even && (high < low || high - low <= 1e-3 * high);
    if (config.mStiffness > 0) out.phases.push_back(config);
  }
  // The engine skips phases of low stiffness even if each constraint has its own stiffness.
  if (!even)
    for (nv::cloth::PhaseConfig& config : out.phases) config.mStiffness = std::max(config.mStiffness, 0.5F);
  const nv::cloth::Range<const std::uint32_t> no_anchors;
  const nv::cloth::Range<const float> no_values;
  tethers = tethers && s.pin_count > 0;
  out.fabric =
      require(factory.createFabric(data.mNumParticles, data.mPhaseIndices, data.mSets, data.mRestvalues,
                                   even ? no_values : range(each), data.mIndices, tethers ? data.mAnchors : no_anchors,
                                   tethers ? data.mTetherLengths : no_values, data.mTriangles),
              "Factory::createFabric");
  return out;
}

std::string obstacle(const Settings& settings, const ClothbenchScene& s) {
  const std::vector<double> w = peer::inverse_masses(s);
  if (std::all_of(w.begin(), w.end(), [](double x) { return x == 0; }))
    return "NvCloth's cooker makes no fabric where every vertex is pinned";
  if (s.vertex_count > 65000) return "NvCloth numbers particles with 16 bits, so a cloth has at most 65000 vertices";
  for (std::uint32_t k = 0; k < s.collider_count && !(settings.frictionless_triangles > 0); ++k)
    if (s.colliders[k].shape == CLOTHBENCH_SHAPE_MESH && s.colliders[k].friction > 0)
      return "NvCloth's collision with triangles has no friction (solver.frictionless_triangles=1 runs it without)";
  return Colliders(s, {}, 0).obstacle();
}

class Solver : public peer::Adapter {
 public:
  /// Throws std::runtime_error with the reason if the engine cannot run the scene.
  Solver(const Settings& settings, const ClothbenchScene& s)
      : Adapter("simulate", s),
        settings_(settings),
        iteration_s_(1 / s.frame_rate_hz / settings.iterations(1 / s.frame_rate_hz)),
        inverse_mass_(peer::inverse_masses(s)),
        colliders_(s, origin, settings.margin_m) {
    if (const std::string why = obstacle(settings, s); !why.empty()) throw std::runtime_error(why);
    engine();
    factory_ = require(NvClothCreateFactoryCPU(), "NvClothCreateFactoryCPU");
    cooked_ = cook(*factory_, s, inverse_mass_, settings.tethers > 0, iteration_s_);
    solver_ = factory_->createSolver();
    restart(peer::start_of(s));
  }
  ~Solver() {
    drop_cloth();
    NV_CLOTH_DELETE(solver_);
    cooked_.fabric->decRefCount();
    NvClothDestroyFactory(factory_);
  }
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  /// The engine stores velocities as differences of positions, so previous positions are set one iteration back.
  void restart(const ClothbenchRestart& start) {
    drop_cloth();
    colliders_.put(start.poses);
    std::vector<PxVec4> now;
    for (std::uint32_t v = 0; v < scene.vertex_count; ++v)
      now.push_back(to_engine(peer::point(start.position_m, v) - origin, inverse_mass_[v]));
    cloth_ = require(factory_->createCloth(range(now), *cooked_.fabric), "Factory::createCloth");
    nv::cloth::MappedRange<PxVec4> before = cloth_->getPreviousParticles();
    for (std::uint32_t v = 0; v < scene.vertex_count; ++v) {
      if (!(inverse_mass_[v] > 0)) continue;
      const Point x = peer::point(start.position_m, v) - iteration_s_ * peer::point(start.velocity_m_per_s, v);
      before[v] = to_engine(x - origin, inverse_mass_[v]);
    }
    set_constants();
    colliders_.place(*cloth_);
    if (colliders_.has_spheres()) add_virtual_particles();
    solver_->addCloth(cloth_);
    attach(start.grip_position_m, start.grip_held);
  }

  std::int32_t step(const ClothbenchFrame& frame) {
    attach(frame.grip_position_m, frame.grip_held);
    if (frame.grip_teleports != nullptr) cloth_->clearInterpolation();
    colliders_.move(*cloth_, frame);
    iteration_s_ = frame.dt_s / settings_.iterations(frame.dt_s);
    const double frequency_hz = settings_.substeps > 0 ? settings_.substeps / frame.dt_s : settings_.frequency_hz;
    cloth_->setSolverFrequency(static_cast<float>(frequency_hz));
    solver_->beginSimulation(static_cast<float>(frame.dt_s));
    for (int chunk = 0; chunk < solver_->getSimulationChunkCount(); ++chunk) solver_->simulateChunk(chunk);
    solver_->endSimulation();
    const nv::cloth::MappedRange<const PxVec4> x = nv::cloth::readCurrentParticles(*cloth_);
    for (std::uint32_t v = 0; v < scene.vertex_count; ++v)
      if (!std::isfinite(x[v].x + x[v].y + x[v].z)) return CLOTHBENCH_NOT_FINITE;
    return CLOTHBENCH_OK;
  }

  void read(double* position_m, double* velocity_m_per_s) const {
    const nv::cloth::Cloth& cloth = *cloth_;
    const auto now = cloth.getCurrentParticles(), before = cloth.getPreviousParticles();
    for (std::uint32_t v = 0; v < scene.vertex_count; ++v)
      for (unsigned k = 0; k < 3; ++k) {
        const double x = static_cast<double>(now[v][k]), last = static_cast<double>(before[v][k]);
        position_m[3 * v + k] = origin[k] + x / kPerMetre;
        velocity_m_per_s[3 * v + k] = inverse_mass_[v] > 0 ? (x - last) / kPerMetre / iteration_s_ : 0;
      }
  }

  double margin_m(std::uint32_t collider) const { return peer::margin(settings_.margin_m, scene.colliders[collider]); }

 private:
  void drop_cloth() {
    if (cloth_ == nullptr) return;
    solver_->removeCloth(cloth_);
    NV_CLOTH_DELETE(cloth_);
    cloth_ = nullptr;
  }

  void set_constants() {
    const Point g = kPerMetre * peer::point(scene.gravity_m_per_s2, 0);
    const bool friction = peer::needs(scene, CLOTHBENCH_FRICTION) && scene.collider_count > 0;
    cloth_->setStiffnessFrequency(static_cast<float>(1 / iteration_s_));
    cloth_->setGravity(PxVec3(static_cast<float>(g[0]), static_cast<float>(g[1]), static_cast<float>(g[2])));
    // The fraction of velocity that an iteration removes.
    cloth_->setDamping(PxVec3(static_cast<float>(-std::expm1(-scene.damping_per_s * iteration_s_))));
    cloth_->setPhaseConfig(range(cooked_.phases));
    cloth_->setFriction(static_cast<float>(friction ? scene.colliders[0].friction : 0));
    cloth_->enableContinuousCollision(colliders_.has_spheres());
  }

  /// Adds a particle at the middle of each triangle. The engine tests these only against spheres and capsules.
  void add_virtual_particles() {
    std::vector<std::array<std::uint32_t, 4>> particles;
    for (std::uint32_t t = 0; t < scene.triangle_count; ++t) {
      const std::uint32_t* v = scene.triangles + 3 * t;
      particles.push_back({v[0], v[1], v[2], 0});
    }
    const std::vector<PxVec3> weights = {PxVec3(1.0F / 3)};
    using Indices = const std::uint32_t[4];
    auto* first = reinterpret_cast<Indices*>(particles.data());
    cloth_->setVirtualParticles(nv::cloth::Range<Indices>(first, first + particles.size()), range(weights));
  }

  /// Attaches vertices by motion constraints of radius 0, which the engine interpolates over the frame's iterations.
  /// `position_m`, `held`: one entry per grip. If null, all grips hold their vertices at the initial positions.
  void attach(const double* position_m, const std::uint8_t* held) {
    if (scene.grip_count == 0) return;
    const nv::cloth::Range<PxVec4> spheres = cloth_->getMotionConstraints();
    std::fill(spheres.begin(), spheres.end(), PxVec4(0, 0, 0, kFree));
    for (std::uint32_t k = 0; k < scene.grip_count; ++k) {
      const std::uint32_t v = scene.grips[k];
      if (held != nullptr && held[k] == 0) continue;
      const Point at = position_m != nullptr ? peer::point(position_m, k) : peer::point(scene.position_m, v);
      spheres[v] = to_engine(at - origin, 0);
    }
  }

  Settings settings_;
  double iteration_s_;
  std::vector<double> inverse_mass_;  ///< [1/kg], 0 where pinned
  Colliders colliders_;
  nv::cloth::Factory* factory_ = nullptr;
  nv::cloth::Solver* solver_ = nullptr;
  nv::cloth::Cloth* cloth_ = nullptr;
  Cooked cooked_;
};

/// The engine's integrator: v += (v e^(-c h) - v) + g h, x += h v.
double free_fall_m(const double* values, double dt_s, double gravity, double velocity, double damping,
                   std::int32_t frames) {
  const int n = Settings(values).iterations(dt_s);
  const double h = dt_s / n, kept = std::exp(-damping * h);
  return peer::fallen_m(std::int64_t{frames} * n, h, velocity, [=](double v) { return kept * v + h * gravity; });
}

const ClothbenchSetting kSettings[] = {
    {"solver_frequency_hz", "solver iterations per second (setSolverFrequency)", 300, 0},
    {"substeps", "solver iterations per frame, instead of the solver frequency; 0: by the frequency", 0, 1},
    {"tethers", "1: geodesic tethers to the pins", 1, 1},
    {"collision_margin_m", "contact offset of all colliders; 0: the scene's margins", 0, 0},
    {"frictionless_triangles", "1: run scenes whose meshes have friction, but without friction; 0: refuse them", 0, 1}};

}  // namespace
}  // namespace clothbench::nvcloth

CLOTHBENCH_PEER(clothbench::nvcloth, "nvcloth", "NvCloth", "float32",
                "NvCloth 1.1.6 on one CPU core (SSE2), lengths in cm")
