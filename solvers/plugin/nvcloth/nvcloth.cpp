// NvCloth on a CPU core, or on a GPU by CUDA, behind clothbench_plugin.h.
#include <NvCloth/Cloth.h>
#include <NvCloth/Fabric.h>
#include <NvClothExt/ClothFabricCooker.h>

#include "nvcloth/colliders.hpp"
#include "nvcloth/engine.hpp"

namespace clothbench::nvcloth {
namespace {

constexpr double kFrequency_hz = 300;  // solver iterations per second, the engine's default
constexpr float kFree = 1e7F;          // radius [cm] of a motion constraint that does not act

struct Settings {
  double substeps, margin_m, frictionless_triangles;
  /// Solver iterations in a frame of `dt_s` seconds, rounded like the engine does.
  int steps(double dt_s) const {
    const double n = substeps > 0 ? substeps : std::floor(dt_s * kFrequency_hz + 0.5);
    return static_cast<int>(std::max(1.0, n));
  }
};

const ClothbenchSetting kSettings[] = {
    {"substeps", "solver iterations per frame; 0: 300 per second, the engine's default", 0, 1},
    {"collision_margin_m", "contact offset of all colliders; 0: the scene's margins", 0, 0},
    {"frictionless_triangles", "1: run scenes whose meshes have friction, but without friction; 0: refuse them", 0, 1}};

using Springs = std::map<peer::Pair, ClothbenchEdge>;

/// A connected part of the cloth: one cloth of the engine, which simulates many at once on a GPU.
struct Sheet {
  std::vector<std::uint32_t> vertices;                         ///< indices in the scene
  std::vector<std::pair<std::uint32_t, std::uint32_t>> grips;  ///< indices in the scene and in `vertices`
  std::vector<std::uint32_t> triangles;                        ///< indices in `vertices`
  std::vector<Point> rest;                                     ///< [m]
  std::vector<double> inverse_mass, springs;                   ///< [1/kg], 0 where pinned; [N/m]
  Point origin;                                                ///< of the engine's coordinates [m]
  std::shared_ptr<nv::cloth::Fabric> fabric;
  std::vector<nv::cloth::PhaseConfig> phases;  ///< phases that the scene needs, with their stiffness
  Shapes colliders;                            ///< at the end of the last frame
  std::unique_ptr<nv::cloth::Cloth> cloth;
};

/// Divides the cloth into its connected parts, in the order of their first vertices.
std::vector<Sheet> sheets_of(const ClothbenchScene& s) {
  std::vector<std::uint32_t> before(s.vertex_count), sheet(s.vertex_count), local(s.vertex_count);
  for (std::uint32_t v = 0; v < s.vertex_count; ++v) before[v] = v;
  const auto first = [&](std::uint32_t v) {
    while (before[v] != v) v = before[v] = before[before[v]];
    return v;
  };
  for (std::uint32_t k = 0; k < s.structural_count; ++k) {
    const std::uint32_t a = first(s.structural_edges[k].a), b = first(s.structural_edges[k].b);
    before[std::max(a, b)] = std::min(a, b);
  }
  const std::vector<double> inverse_mass = peer::inverse_masses(s);
  std::vector<Sheet> out;
  for (std::uint32_t v = 0; v < s.vertex_count; ++v) {
    if (first(v) == v) out.emplace_back();
    sheet[v] = first(v) == v ? static_cast<std::uint32_t>(out.size() - 1) : sheet[first(v)];
    Sheet& part = out[sheet[v]];
    local[v] = static_cast<std::uint32_t>(part.vertices.size());
    part.vertices.push_back(v);
    part.rest.push_back(peer::point(s.rest_position_m, v));
    part.inverse_mass.push_back(inverse_mass[v]);
  }
  for (std::uint32_t n = 0; n < 3 * s.triangle_count; ++n)
    out[sheet[s.triangles[n]]].triangles.push_back(local[s.triangles[n]]);
  for (std::uint32_t k = 0; k < s.structural_count; ++k)
    out[sheet[s.structural_edges[k].a]].springs.push_back(s.structural_edges[k].spring_N_per_m);
  for (std::uint32_t k = 0; k < s.grip_count; ++k) out[sheet[s.grips[k]]].grips.emplace_back(k, local[s.grips[k]]);
  for (Sheet& part : out) {
    // Rest positions count from the first vertex, so that parts far from the origin lose no digits in float32.
    const Point shift = out.size() > 1 ? part.rest.front() : Point{};
    for (Point& p : part.rest) p = p - shift;
    std::vector<Point> start;
    for (const std::uint32_t v : part.vertices) start.push_back(peer::point(s.position_m, v));
    part.origin = peer::centre(start);
  }
  return out;
}

/// Whether two sheets are copies, so that one fabric serves both.
bool are_copies(const Sheet& a, const Sheet& b) {
  const auto near = [](double x, double y) { return x == y || std::abs(x - y) <= 1e-12 + 1e-9 * std::abs(x); };
  const auto close = [&](const Point& x, const Point& y) { return std::equal(x.begin(), x.end(), y.begin(), near); };
  return a.triangles == b.triangles && std::equal(a.rest.begin(), a.rest.end(), b.rest.begin(), b.rest.end(), close) &&
         std::equal(a.inverse_mass.begin(), a.inverse_mass.end(), b.inverse_mass.begin(), b.inverse_mass.end(), near) &&
         std::equal(a.springs.begin(), a.springs.end(), b.springs.begin(), b.springs.end(), near);
}

template <typename T>
void describe(nv::cloth::BoundedData& to, const std::vector<T>& from, std::size_t per_item = 1) {
  to.data = from.data();
  to.count = static_cast<physx::PxU32>(from.size() / per_item);
  to.stride = static_cast<physx::PxU32>(per_item * sizeof(T));
}

/// Makes the fabric of the sheet at rest. `NvClothExt`'s cooker sorts constraints into phases: vertical and horizontal
/// edges, diagonals, and pairs two edges apart for bending; tethers lead to pins. Phases that no spring of the scene
/// needs are omitted. The stiffness of a constraint is the fraction of its error that one iteration removes, W k h^2 /
/// (1 + W k h^2), W: sum of inverse masses, k: spring stiffness. Each iteration here is a whole step of h, so this is
/// equivalent to compliance 1 / k (Macklin et al., XPBD, 2016, eq. 18 with lambda = 0).
void make_fabric(const nv::cloth::CookedData& data, const Springs& springs, double iteration_s, Sheet& sheet) {
  const std::vector<double>& inverse_mass = sheet.inverse_mass;
  const auto error_fraction = [&](std::uint32_t a, std::uint32_t b) {
    const auto spring = springs.find(peer::pair(sheet.vertices[a], sheet.vertices[b]));
    if (spring == springs.end()) return 0.0;
    if (std::isinf(spring->second.spring_N_per_m)) return 1.0;
    const double x = (inverse_mass[a] + inverse_mass[b]) * spring->second.spring_N_per_m * iteration_s * iteration_s;
    return x / (1 + x);
  };
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
    if (config.mStiffness > 0) sheet.phases.push_back(config);
  }
  // The engine skips phases of low stiffness even if each constraint has its own stiffness.
  for (nv::cloth::PhaseConfig& config : sheet.phases)
    if (!even) config.mStiffness = std::max(config.mStiffness, 0.5F);
  if (even) each.clear();
  std::vector<float> lengths(data.mTetherLengths.begin(), data.mTetherLengths.end());
  // On CUDA the engine rounds lengths to 16 bits of the greatest, so that a tether would move a pinned vertex.
  for (std::size_t k = 0; k < lengths.size(); ++k)
    if (inverse_mass[k % data.mNumParticles] == 0) lengths[k] = *std::max_element(lengths.begin(), lengths.end());
  nv::cloth::Fabric* fabric =
      device().factory->createFabric(data.mNumParticles, data.mPhaseIndices, data.mSets, data.mRestvalues, range(each),
                                     data.mIndices, data.mAnchors, range(lengths), data.mTriangles);
  sheet.fabric.reset(require(fabric, "Factory::createFabric"), [](nv::cloth::Fabric* f) { f->decRefCount(); });
}

/// Passes the sheet at rest to the engine's cooker: quads of a grid, triangles of a mesh.
void cook(const ClothbenchScene& s, const Springs& springs, double iteration_s, Sheet& sheet) {
  std::vector<PxVec3> points;
  for (const Point& p : sheet.rest) points.push_back(to_engine(p, 0).getXYZ());
  const std::vector<float> weights(sheet.inverse_mass.begin(), sheet.inverse_mass.end());
  std::vector<std::uint32_t> quads;
  for (std::uint32_t j = 0; j + 1 < s.rows; ++j)
    for (std::uint32_t a = j * s.columns; a + 1 < (j + 1) * s.columns; ++a)
      quads.insert(quads.end(), {a, a + 1, a + 1 + s.columns, a + s.columns});
  nv::cloth::ClothMeshDesc mesh;
  describe(mesh.points, points);
  describe(mesh.invMasses, weights);
  if (quads.empty())
    describe(mesh.triangles, sheet.triangles, 3);
  else
    describe(mesh.quads, quads, 4);
  const std::unique_ptr<nv::cloth::ClothFabricCooker> cooker(NvClothCreateFabricCooker());
  require(cooker->cook(mesh, PxVec3(0, 1, 0), true) ? cooker.get() : nullptr, "ClothFabricCooker::cook");
  make_fabric(cooker->getCookedData(), springs, iteration_s, sheet);
}

class Solver : public peer::Adapter<Settings> {
 public:
  static constexpr bool kOnGpu = Device::kOnGpu;

  /// Throws std::runtime_error with the reason if the engine cannot run the scene.
  Solver(const Settings& given, const ClothbenchScene& s)
      : Adapter("simulate", given, s),
        iteration_s_(1 / s.frame_rate_hz / given.steps(1 / s.frame_rate_hz)),
        solver_(require(device().factory->createSolver(), "Factory::createSolver")),
        sheets_(sheets_of(s)) {
    const Springs springs = peer::springs(s, true);
    for (std::size_t k = 0; k < sheets_.size(); ++k)
      if (k > 0 && are_copies(sheets_[k - 1], sheets_[k])) {
        sheets_[k].fabric = sheets_[k - 1].fabric;
        sheets_[k].phases = sheets_[k - 1].phases;
      } else {
        cook(s, springs, iteration_s_, sheets_[k]);
      }
    restart(peer::start_of(s));
  }
  ~Solver() {
    for (Sheet& sheet : sheets_) solver_->removeCloth(sheet.cloth.get());
  }

  static std::string obstacle(const Settings& settings, const ClothbenchScene& s) {
    if (!device().obstacle.empty()) return device().obstacle;
    for (const Sheet& sheet : sheets_of(s)) {
      const std::vector<double>& w = sheet.inverse_mass;
      if (std::all_of(w.begin(), w.end(), [](double x) { return x == 0; }))
        return "NvCloth's cooker makes no fabric where every vertex is pinned";
      if (w.size() > 65000) return "NvCloth numbers particles with 16 bits, so a cloth has at most 65000 vertices";
    }
    const Shapes shapes = shapes_of(s, s.poses, {}, 0);
    for (std::uint32_t k = 0; k < s.collider_count; ++k) {
      if (s.colliders[k].triangle_count > 0 && s.colliders[k].friction > 0 && !(settings.frictionless_triangles > 0))
        return "NvCloth's collision with triangles has no friction (solver.frictionless_triangles=1 runs it without)";
      if (s.colliders[k].friction != s.colliders[0].friction)
        return "NvCloth has one coefficient of friction for all colliders";
    }
    if (const std::size_t n = shapes.triangles.size() / 3; kOnGpu && n > 500)
      return "NvCloth on CUDA collides with at most 500 triangles; the scene has " + std::to_string(n);
    if (shapes.spheres.size() > kMaxShapes || shapes.capsules.size() > 2 * kMaxShapes)
      return "NvCloth collides with at most 32 spheres and ends of capsules";
    return shapes.planes.size() > kMaxShapes ? "NvCloth collides with at most 32 planes and sides of boxes" : "";
  }

  /// Makes the cloths anew, so that nothing of their past remains.
  void restart(const ClothbenchRestart& start) {
    for (Sheet& sheet : sheets_) {
      if (sheet.cloth) solver_->removeCloth(sheet.cloth.get());
      make(sheet, start);
      solver_->addCloth(sheet.cloth.get());
      attach(sheet, start.grip_position_m, start.grip_held);
    }
    if (!kOnGpu || scene.grip_count == 0) return;
    // The kernel interpolates attachments only from targets that an earlier launch has read.
    simulate(iteration_s_, 1 / iteration_s_);
    for (Sheet& sheet : sheets_) put(sheet, start);
  }

  std::int32_t step(const ClothbenchFrame& frame) {
    iteration_s_ = frame.dt_s / settings.steps(frame.dt_s);
    for (Sheet& sheet : sheets_) {
      attach(sheet, frame.grip_position_m, frame.grip_held);
      if (frame.grip_teleports != nullptr) sheet.cloth->clearInterpolation();
      move_colliders(sheet, frame);
    }
    const double frequency_hz = settings.substeps > 0 ? settings.substeps / frame.dt_s : kFrequency_hz;
    return simulate(frame.dt_s, frequency_hz) ? CLOTHBENCH_OK : CLOTHBENCH_DEVICE_LOST;
  }

  void read(double* position_m, double* velocity_m_per_s) const {
    for (const Sheet& sheet : sheets_) {
      const auto now = readCurrentParticles(*sheet.cloth), before = readPreviousParticles(*sheet.cloth);
      for (std::uint32_t v = 0; v < sheet.vertices.size(); ++v)
        for (unsigned k = 0; k < 3; ++k) {
          const double x = static_cast<double>(now[v][k]), way = x - static_cast<double>(before[v][k]);
          position_m[3 * sheet.vertices[v] + k] = sheet.origin[k] + x / kPerMetre;
          velocity_m_per_s[3 * sheet.vertices[v] + k] = sheet.inverse_mass[v] > 0 ? way / kPerMetre / iteration_s_ : 0;
        }
    }
  }

  double device_s() const { return device().frame_s; }
  ClothbenchDevice device_info() const {
    return {device().name.c_str(), device().api.c_str(), device().api.c_str(), 0, nullptr};
  }
  double margin_m(std::uint32_t collider) const { return peer::margin(settings.margin_m, scene.colliders[collider]); }

  /// The engine's integrator: v += (v e^(-c h) - v) + g h.
  static double next_velocity(double velocity, double h, double gravity, double damping) {
    return std::exp(-damping * h) * velocity + h * gravity;
  }

 private:
  bool simulate(double dt_s, double frequency_hz) {
    for (Sheet& sheet : sheets_) sheet.cloth->setSolverFrequency(static_cast<float>(frequency_hz));
    solver_->beginSimulation(static_cast<float>(dt_s));
    device().start();
    for (int chunk = 0; chunk < solver_->getSimulationChunkCount(); ++chunk) solver_->simulateChunk(chunk);
    device().stop();
    solver_->endSimulation();
    return device().finish() && !solver_->hasError();
  }

  void make(Sheet& sheet, const ClothbenchRestart& start) {
    sheet.colliders = shapes_of(scene, start.poses, sheet.origin, settings.margin_m);
    std::vector<PxVec4> now;
    for (std::size_t v = 0; v < sheet.vertices.size(); ++v) now.push_back(particle(sheet, v, start, 0));
    sheet.cloth.reset(require(device().factory->createCloth(range(now), *sheet.fabric), "Factory::createCloth"));
    put(sheet, start);
    nv::cloth::Cloth& cloth = *sheet.cloth;
    cloth.setStiffnessFrequency(static_cast<float>(1 / iteration_s_));
    cloth.setGravity(to_engine(peer::point(scene.gravity_m_per_s2, 0), 0).getXYZ());
    // The fraction of velocity that an iteration removes.
    cloth.setDamping(PxVec3(static_cast<float>(-std::expm1(-scene.damping_per_s * iteration_s_))));
    cloth.setPhaseConfig(range(sheet.phases));
    cloth.setFriction(static_cast<float>(scene.collider_count > 0 ? scene.colliders[0].friction : 0));
    cloth.setSpheres(range(sheet.colliders.spheres), 0, 0);
    cloth.setCapsules(range(sheet.colliders.capsules), 0, 0);
    cloth.setPlanes(range(sheet.colliders.planes), 0, 0);
    cloth.setConvexes(range(sheet.colliders.convexes), 0, 0);
    cloth.setTriangles(range(sheet.colliders.triangles), 0, 0);
    if (sheet.colliders.spheres.empty()) return;
    cloth.enableContinuousCollision(true);
    // Particles at the middles of triangles. The engine tests these only against spheres and capsules.
    std::vector<std::array<std::uint32_t, 4>> middles;
    for (std::size_t t = 0; t < sheet.triangles.size(); t += 3)
      middles.push_back({sheet.triangles[t], sheet.triangles[t + 1], sheet.triangles[t + 2], 0});
    const std::vector<PxVec3> weights = {PxVec3(1.0F / 3)};
    using Indices = const std::uint32_t[4];
    auto* first = reinterpret_cast<Indices*>(middles.data());
    cloth.setVirtualParticles(nv::cloth::Range<Indices>(first, first + middles.size()), range(weights));
  }

  /// A vertex `earlier_s` before a state. The engine stores velocities as differences of positions.
  static PxVec4 particle(const Sheet& sheet, std::size_t v, const ClothbenchRestart& at, double earlier_s) {
    const std::uint32_t k = sheet.vertices[v];
    const Point x = peer::point(at.position_m, k) - earlier_s * peer::point(at.velocity_m_per_s, k);
    return to_engine(x - sheet.origin, sheet.inverse_mass[v]);
  }

  /// Gives a cloth the positions and velocities of a state.
  void put(Sheet& sheet, const ClothbenchRestart& start) const {
    const auto now = sheet.cloth->getCurrentParticles(), before = sheet.cloth->getPreviousParticles();
    for (std::uint32_t v = 0; v < sheet.vertices.size(); ++v) {
      now[v] = particle(sheet, v, start, 0);
      before[v] = particle(sheet, v, start, sheet.inverse_mass[v] > 0 ? iteration_s_ : 0);
    }
  }

  /// Attaches vertices by motion constraints of radius 0, which the engine interpolates over the frame's iterations.
  /// `position_m`, `held`: one entry per grip. If null, all grips hold their vertices at the initial positions.
  void attach(Sheet& sheet, const double* position_m, const std::uint8_t* held) const {
    if (sheet.grips.empty()) return;
    const nv::cloth::Range<PxVec4> spheres = sheet.cloth->getMotionConstraints();
    std::fill(spheres.begin(), spheres.end(), PxVec4(0, 0, 0, kFree));
    for (const auto& [k, v] : sheet.grips) {
      if (held != nullptr && held[k] == 0) continue;
      const Point at =
          position_m != nullptr ? peer::point(position_m, k) : peer::point(scene.position_m, scene.grips[k]);
      spheres[v] = to_engine(at - sheet.origin, 0);
    }
  }

  /// Moves colliders from their poses at the end of the last frame; in a frame with a jump, at once.
  void move_colliders(Sheet& sheet, const ClothbenchFrame& frame) const {
    const auto moves = [](const ClothbenchCollider& c) { return c.moves != 0; };
    if (std::none_of(scene.colliders, scene.colliders + scene.collider_count, moves)) return;
    Shapes now = shapes_of(scene, frame.poses, sheet.origin, settings.margin_m);
    if (frame.collider_teleports != nullptr) sheet.colliders = now;
    if (!now.spheres.empty()) sheet.cloth->setSpheres(range(sheet.colliders.spheres), range(now.spheres));
    if (!now.triangles.empty()) sheet.cloth->setTriangles(range(sheet.colliders.triangles), range(now.triangles), 0);
    sheet.colliders = std::move(now);
  }

  double iteration_s_;
  std::unique_ptr<nv::cloth::Solver> solver_;
  std::vector<Sheet> sheets_;  ///< destroyed before the solver
};

}  // namespace
}  // namespace clothbench::nvcloth

#ifdef NVCLOTH_CUDA
CLOTHBENCH_PEER(clothbench::nvcloth, "nvcloth-cuda", "NvCloth", "float32",
                "NvCloth 1.1.6 on a GPU (CUDA), lengths in cm")
#else
CLOTHBENCH_PEER(clothbench::nvcloth, "nvcloth", "NvCloth", "float32",
                "NvCloth 1.1.6 on one CPU core (SSE2), lengths in cm")
#endif
