/// A scene as NvCloth has it: start of the engine, fabric, colliders. One file includes this.
#pragma once

#include <NvCloth/Callbacks.h>
#include <NvCloth/Cloth.h>
#include <NvCloth/Fabric.h>
#include <NvCloth/Factory.h>
#include <NvCloth/Solver.h>
#include <NvClothExt/ClothFabricCooker.h>
#include <foundation/PxAllocatorCallback.h>
#include <foundation/PxErrorCallback.h>

#include <cstdlib>
#include <map>
#include <memory>
#include <numeric>
#include <stdexcept>

#include "peer.hpp"

namespace clothbench::nvcloth {
using peer::Point, physx::PxVec3, physx::PxVec4;

/// Lengths are in centimetres here, because the engine's epsilons are absolute (1.2e-7 on squared lengths): in metres
/// the cloth stretches two to three times more.
constexpr double kPerMetre = 100;
constexpr std::size_t kMaxShapes = 32;  // the engine keeps sets of shapes in the bits of a word
constexpr float kFree = 1e7F;           // radius [cm] of a motion constraint that does not act

/// A point of the world [m] in the engine's frame [cm], around `origin`; w: radius [cm], inverse mass or nothing.
inline PxVec4 to_engine(const Point& x, const Point& origin, double w) {
  const auto to = [&](std::size_t k) { return static_cast<float>((x[k] - origin[k]) * kPerMetre); };
  return {to(0), to(1), to(2), static_cast<float>(w)};
}

template <typename T>
nv::cloth::Range<const T> range(const std::vector<T>& v) {
  return {v.data(), v.data() + v.size()};
}

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

void start_engine() {
  static Memory memory;
  static Asserts asserts;
  static const bool once = (nv::cloth::InitializeNvCloth(&memory, &messages(), &asserts, nullptr), true);
  (void)once;
}

void require(const void* made, const char* what) {
  if (made == nullptr) throw std::runtime_error(std::string("NvCloth: ") + what + " failed: " + messages().last);
}

std::vector<double> inverse_masses(const ClothbenchScene& s) {
  std::vector<double> out;
  for (std::uint32_t v = 0; v < s.vertex_count; ++v) out.push_back(1 / s.mass_kg[v]);
  for (std::uint32_t k = 0; k < s.pin_count; ++k) out[s.pins[k]] = 0;
  return out;
}

struct Settings {
  double solver_frequency_hz, substeps, tethers, collision_margin_m, frictionless_triangles;
  explicit Settings(const double* v)
      : solver_frequency_hz(v[0]),
        substeps(v[1]),
        tethers(v[2]),
        collision_margin_m(v[3]),
        frictionless_triangles(v[4]) {}
  double frequency_hz(double frame_rate_hz) const {
    return substeps > 0 ? substeps * frame_rate_hz : solver_frequency_hz;
  }
  /// Solver iterations in a frame of `dt_s` seconds, rounded as the engine rounds.
  int iterations(double dt_s) const {
    const double n = substeps > 0 ? substeps : std::floor(dt_s * solver_frequency_hz + 0.5);
    return static_cast<int>(std::max(1.0, n));
  }
};

struct Deleter {
  void operator()(nv::cloth::ClothFabricCooker* cooker) const { NV_CLOTH_DELETE(cooker); }
};

/// The cells of a grid. A mesh has none.
std::vector<std::uint32_t> quads(const ClothbenchScene& s) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t j = 0; j + 1 < s.rows; ++j)
    for (std::uint32_t i = 0; i + 1 < s.columns; ++i) {
      const std::uint32_t a = j * s.columns + i;
      out.insert(out.end(), {a, a + 1, a + 1 + s.columns, a + s.columns});
    }
  return out;
}

template <typename T>
void describe(nv::cloth::BoundedData& to, const std::vector<T>& from, std::size_t per_item) {
  to.data = from.data();
  to.count = static_cast<physx::PxU32>(from.size() / per_item);
  to.stride = static_cast<physx::PxU32>(per_item * sizeof(T));
}

std::unique_ptr<nv::cloth::ClothFabricCooker, Deleter> cooker_of(const ClothbenchScene& s,
                                                                 const std::vector<peer::Point>& rest,
                                                                 const std::vector<double>& inverse_mass) {
  std::vector<physx::PxVec3> points;
  for (const peer::Point& p : rest) points.push_back(to_engine(p, {}, 0).getXYZ());
  const std::vector<float> weights(inverse_mass.begin(), inverse_mass.end());
  const std::vector<std::uint32_t> cells = quads(s);
  nv::cloth::ClothMeshDesc mesh;
  describe(mesh.points, points, 1);
  describe(mesh.invMasses, weights, 1);
  if (cells.empty()) {
    mesh.triangles.data = s.triangles;
    mesh.triangles.count = s.triangle_count;
    mesh.triangles.stride = 3 * sizeof(std::uint32_t);
  } else {
    describe(mesh.quads, cells, 4);
  }
  std::unique_ptr<nv::cloth::ClothFabricCooker, Deleter> cooker(NvClothCreateFabricCooker());
  const bool done = cooker->cook(mesh, physx::PxVec3(0, 1, 0), true);
  require(done ? cooker.get() : nullptr, "ClothFabricCooker::cook");
  return cooker;
}

/// Stiffness [N/m] of the spring between two vertices. 0 without a spring in the scene.
class Springs {
 public:
  explicit Springs(const ClothbenchScene& s) {
    for (const peer::Spring& p : peer::springs(s))
      stiffness_[{std::min(p.a, p.b), std::max(p.a, p.b)}] = p.stiffness_N_per_m;
  }
  double between(std::uint32_t a, std::uint32_t b) const {
    const auto at = stiffness_.find({std::min(a, b), std::max(a, b)});
    return at == stiffness_.end() ? 0 : at->second;
  }

 private:
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> stiffness_;
};

/// Fraction of a constraint's error that one iteration of `h` seconds removes.
double error_fraction(double stiffness, double inverse_masses, double h) {
  if (std::isinf(stiffness)) return 1;
  const double x = inverse_masses * stiffness * h * h;
  return x / (1 + x);
}

struct Cooked {
  nv::cloth::Fabric* fabric = nullptr;         ///< one reference, the caller's
  std::vector<nv::cloth::PhaseConfig> phases;  ///< phases that the scene needs, with their stiffness
};

/// Fabric of the sheet at rest. `NvClothExt`'s cooker sorts constraints into phases: vertical and horizontal edges,
/// diagonals, and pairs two edges apart for bending; tethers go to the pins. Phases without a spring of the scene are
/// left out. The stiffness of a constraint is the fraction of its error that one iteration removes, W k h^2 / (1 + W k
/// h^2) with the sum W of inverse masses and the spring k. Because an iteration is a step of its own here, this is the
/// compliance of the constraint (Macklin et al., XPBD, 2016, eq. 18 with lambda = 0).
Cooked cook(nv::cloth::Factory& factory, const ClothbenchScene& s, const std::vector<double>& inverse_mass,
            bool with_tethers, double iteration_s) {
  const std::vector<peer::Point> rest = peer::rest_points(s);
  const auto cooker = cooker_of(s, rest, inverse_mass);
  const nv::cloth::CookedData data = cooker->getCookedData();
  const Springs springs(s);
  Cooked out;
  std::vector<float> each(data.mRestvalues.size(), 0);  // logarithm to base 2 of the error fraction that is left
  bool even = true;
  for (std::uint32_t phase = 0; phase < data.mPhaseIndices.size(); ++phase) {
    const std::uint32_t set = data.mPhaseIndices[phase];
    double low = 1, high = 0;
    for (std::uint32_t k = set == 0 ? 0 : data.mSets[set - 1]; k < data.mSets[set]; ++k) {
      const std::uint32_t a = data.mIndices[2 * k], b = data.mIndices[2 * k + 1];
      const double share = error_fraction(springs.between(a, b), inverse_mass[a] + inverse_mass[b], iteration_s);
      each[k] = static_cast<float>(std::max(std::log2(1 - share), -1e30));
      if (inverse_mass[a] > 0 && inverse_mass[b] > 0) low = std::min(low, share), high = std::max(high, share);
    }
    nv::cloth::PhaseConfig config(static_cast<std::uint16_t>(phase));
    const double share = high < low ? 1 : (low + high) / 2;
    config.mStiffness = static_cast<float>(share);
    even = even && (high < low || high - low <= 1e-3 * high);
    // A phase of stiffness 0 is dropped by the engine, and one that each constraint states its own for must not be.
    if (config.mStiffness > 0 || high > 0) out.phases.push_back(config);
  }
  if (!even)
    for (nv::cloth::PhaseConfig& config : out.phases) config.mStiffness = std::max(config.mStiffness, 0.5F);
  const bool tethers = with_tethers && s.pin_count > 0;
  out.fabric = factory.createFabric(data.mNumParticles, data.mPhaseIndices, data.mSets, data.mRestvalues,
                                    even ? nv::cloth::Range<const float>() : range(each), data.mIndices,
                                    tethers ? data.mAnchors : nv::cloth::Range<const std::uint32_t>(),
                                    tethers ? data.mTetherLengths : nv::cloth::Range<const float>(), data.mTriangles);
  require(out.fabric, "Factory::createFabric");
  return out;
}

std::uint32_t capsule_count(const ClothbenchScene& s) {
  std::uint32_t n = 0;
  for (std::uint32_t k = 0; k < s.collider_count; ++k) n += s.colliders[k].capsule_count;
  return n;
}

/// The plane with this outward normal through a point [m], as the engine's equation n x + d = 0 [cm].
PxVec4 plane(const double* normal, const Point& through, const Point& origin, double margin) {
  const Point p = through - origin;
  const double d = -(normal[0] * p[0] + normal[1] * p[1] + normal[2] * p[2]) - margin;
  return {static_cast<float>(normal[0]), static_cast<float>(normal[1]), static_cast<float>(normal[2]),
          static_cast<float>(d * kPerMetre)};
}

Point end_of(const double* capsule, std::size_t end) { return peer::point(capsule, end); }

/// The sphere of each capsule's end, where ends that coincide share one.
std::vector<std::uint32_t> joined(const std::vector<Point>& ends, std::uint32_t& count) {
  std::vector<std::uint32_t> out;
  std::vector<Point> spheres;
  for (const Point& p : ends) {
    const auto at =
        std::find_if(spheres.begin(), spheres.end(), [&](const Point& q) { return peer::length(p - q) < 1e-6; });
    out.push_back(static_cast<std::uint32_t>(at - spheres.begin()));
    if (at == spheres.end()) spheres.push_back(p);
  }
  count = static_cast<std::uint32_t>(spheres.size());
  return out;
}

std::vector<Point> capsule_ends(const ClothbenchScene& s, const ClothbenchPose* poses) {
  std::vector<Point> out;
  for (std::uint32_t k = 0; k < s.collider_count; ++k)
    for (std::uint32_t c = 0; c < s.colliders[k].capsule_count; ++c)
      for (std::size_t end = 0; end < 2; ++end) out.push_back(end_of(poses[k].capsules + 7 * c, end));
  return out;
}

std::uint32_t count_of(const ClothbenchScene& s, std::int32_t shape) {
  std::uint32_t n = 0;
  for (std::uint32_t k = 0; k < s.collider_count; ++k) n += s.colliders[k].shape == shape;
  return n;
}

std::string shape_obstacle(const ClothbenchScene& s) {
  std::uint32_t ends = 0;
  joined(capsule_ends(s, s.poses), ends);
  if (ends + count_of(s, CLOTHBENCH_SHAPE_SPHERE) > kMaxShapes || capsule_count(s) > kMaxShapes)
    return "NvCloth collides with at most 32 spheres and ends of capsules";
  if (count_of(s, CLOTHBENCH_SHAPE_PLANE) + 6 * count_of(s, CLOTHBENCH_SHAPE_BOX) > kMaxShapes)
    return "NvCloth collides with at most 32 planes and sides of boxes";
  for (std::uint32_t k = 1; k < s.collider_count; ++k)
    if (s.colliders[k].friction != s.colliders[0].friction)
      return "NvCloth has one coefficient of friction for all colliders";
  return "";
}

/// Shapes are inflated by their margins. Planes and boxes are convexes, whose corners stay sharp; vertices of triangles
/// move along their normals.
class Colliders {
 public:
  /// `margin_m`: in place of the colliders' margins; 0: theirs.
  Colliders(const ClothbenchScene&, const peer::Point& origin, double margin_m);

  bool has_spheres() const { return !now_.spheres.empty(); }
  double friction() const;
  /// Gives a new cloth the colliders as they are at the start of the next frame.
  void place(nv::cloth::Cloth&) const;
  /// Lets moving colliders go from where they are to the frame's poses; one that teleports is there at once.
  void move(nv::cloth::Cloth&, const ClothbenchFrame&);
  void put(const ClothbenchPose* poses) { now_ = at(poses); }

 private:
  struct Shapes {
    std::vector<PxVec4> spheres, planes;
    std::vector<PxVec3> triangles;
  };
  Shapes at(const ClothbenchPose*) const;
  void add_mesh(const ClothbenchCollider&, const double* vertices_m, Shapes&) const;

  const ClothbenchScene& scene_;
  peer::Point origin_;
  double margin_m_;
  std::vector<std::uint32_t> ends_;  ///< sphere of each end of all capsules
  std::uint32_t capsule_spheres_ = 0;
  std::vector<std::uint32_t> convexes_;  ///< sets of planes
  Shapes now_;                           ///< where the last frame left them
  bool moves_ = false;
};

Colliders::Colliders(const ClothbenchScene& s, const Point& origin, double margin_m)
    : scene_(s), origin_(origin), margin_m_(margin_m) {
  const std::vector<Point> ends = capsule_ends(s, s.poses);
  ends_.resize(ends.size());
  std::iota(ends_.begin(), ends_.end(), 0U);
  capsule_spheres_ = static_cast<std::uint32_t>(ends.size());
  if (ends.size() + count_of(s, CLOTHBENCH_SHAPE_SPHERE) > kMaxShapes) ends_ = joined(ends, capsule_spheres_);
  for (std::uint32_t k = 0, planes = 0; k < s.collider_count; ++k) {
    const std::int32_t shape = s.colliders[k].shape;
    const std::uint32_t sides = shape == CLOTHBENCH_SHAPE_PLANE ? 1 : shape == CLOTHBENCH_SHAPE_BOX ? 6 : 0;
    if (sides > 0) convexes_.push_back(((1U << sides) - 1) << planes);
    planes += sides;
    moves_ = moves_ || s.colliders[k].moves != 0;
  }
  put(s.poses);
}

double Colliders::friction() const { return scene_.collider_count > 0 ? scene_.colliders[0].friction : 0; }

Colliders::Shapes Colliders::at(const ClothbenchPose* poses) const {
  Shapes out;
  out.spheres.resize(capsule_spheres_, PxVec4(0.0F));
  std::uint32_t end = 0;
  for (std::uint32_t k = 0; k < scene_.collider_count; ++k) {
    const ClothbenchCollider& c = scene_.colliders[k];
    const double margin = peer::margin(margin_m_, c);
    const Point middle = peer::point(c.center_m, 0);
    if (c.shape == CLOTHBENCH_SHAPE_SPHERE)
      out.spheres.push_back(to_engine(middle, origin_, (c.radius_m + margin) * kPerMetre));
    if (c.shape == CLOTHBENCH_SHAPE_PLANE) out.planes.push_back(plane(c.normal, middle, origin_, margin));
    if (c.shape == CLOTHBENCH_SHAPE_MESH) add_mesh(c, poses[k].vertices_m, out);
    for (std::size_t axis = 0; c.shape == CLOTHBENCH_SHAPE_BOX && axis < 3; ++axis)
      for (const double sign : {1.0, -1.0}) {
        Point through = middle, normal{};
        for (std::size_t i = 0; i < 3; ++i) {
          normal[i] = sign * c.axes[3 * axis + i];
          through[i] += normal[i] * c.half_extent_m[axis];
        }
        out.planes.push_back(plane(normal.data(), through, origin_, margin));
      }
    for (std::uint32_t n = 0; n < 2 * c.capsule_count; ++n, ++end) {
      const double* capsule = poses[k].capsules + 7 * (n / 2);
      PxVec4& sphere = out.spheres[ends_[end]];
      const double radius = std::max(static_cast<double>(sphere.w), (capsule[6] + margin) * kPerMetre);
      sphere = to_engine(end_of(capsule, n % 2), origin_, radius);
    }
  }
  return out;
}

void Colliders::add_mesh(const ClothbenchCollider& c, const double* vertices_m, Shapes& out) const {
  const double margin = peer::margin(margin_m_, c);
  const std::vector<Point> normals = peer::vertex_normals(c, vertices_m);
  for (std::uint32_t k = 0; k < 3 * c.triangle_count; ++k) {
    const std::uint32_t v = c.triangles[k];
    Point p = peer::point(vertices_m, v);
    for (std::size_t i = 0; i < 3; ++i) p[i] += margin * normals[v][i];
    out.triangles.push_back(to_engine(p, origin_, 0).getXYZ());
  }
}

void Colliders::place(nv::cloth::Cloth& cloth) const {
  cloth.setSpheres(range(now_.spheres), 0, 0);
  cloth.setCapsules(range(ends_), 0, 0);
  cloth.setPlanes(range(now_.planes), 0, 0);
  cloth.setConvexes(range(convexes_), 0, 0);
  cloth.setTriangles(range(now_.triangles), 0, 0);
}

void Colliders::move(nv::cloth::Cloth& cloth, const ClothbenchFrame& frame) {
  if (!moves_) return;
  Shapes start = std::move(now_);
  now_ = at(frame.poses);
  if (frame.collider_teleports != nullptr) {
    std::vector<ClothbenchPose> from(frame.poses_before, frame.poses_before + scene_.collider_count);
    for (std::uint32_t k = 0; k < scene_.collider_count; ++k)
      if (frame.collider_teleports[k] != 0) from[k] = frame.poses[k];
    start = at(from.data());
  }
  if (!now_.spheres.empty()) cloth.setSpheres(range(start.spheres), range(now_.spheres));
  if (!now_.triangles.empty()) cloth.setTriangles(range(start.triangles), range(now_.triangles), 0);
}

}  // namespace clothbench::nvcloth
