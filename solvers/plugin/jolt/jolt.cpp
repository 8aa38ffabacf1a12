// Jolt's soft bodies behind clothbench_plugin.h.

// clang-format off: Jolt.h comes before every other header of the engine.
#include <Jolt/Jolt.h>
// clang-format on

#include <Jolt/Core/Factory.h>
#include <Jolt/Core/JobSystemSingleThreaded.h>
#include <Jolt/Core/TempAllocator.h>
#include <Jolt/Physics/Body/BodyCreationSettings.h>
#include <Jolt/Physics/Collision/BroadPhase/BroadPhaseLayerInterfaceTable.h>
#include <Jolt/Physics/Collision/BroadPhase/ObjectVsBroadPhaseLayerFilterTable.h>
#include <Jolt/Physics/Collision/ObjectLayerPairFilterTable.h>
#include <Jolt/Physics/Collision/Shape/BoxShape.h>
#include <Jolt/Physics/Collision/Shape/CapsuleShape.h>
#include <Jolt/Physics/Collision/Shape/MeshShape.h>
#include <Jolt/Physics/Collision/Shape/PlaneShape.h>
#include <Jolt/Physics/Collision/Shape/SphereShape.h>
#include <Jolt/Physics/PhysicsSystem.h>
#include <Jolt/Physics/SoftBody/SoftBodyCreationSettings.h>
#include <Jolt/Physics/SoftBody/SoftBodyMotionProperties.h>
#include <Jolt/Physics/SoftBody/SoftBodySharedSettings.h>
#include <Jolt/RegisterTypes.h>

#include "peer.hpp"

namespace clothbench::jolt {
namespace {

using JPH::EMotionType, JPH::Quat, JPH::Vec3, peer::kSupports, peer::Point;
using Shared = JPH::SoftBodySharedSettings;

constexpr JPH::ObjectLayer kCloth = 0, kObstacle = 1;
/// Compliance of bend constraints [m/N]. With 1e-5, as in the engine's samples, an inextensible 64 x 64 sheet tears.
constexpr float kBendCompliance = 1e-2F;

Vec3 vec3(const double* x) { return {static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])}; }

/// Converts a point [m] to the engine's float32 coordinates relative to `origin`.
Vec3 to_engine(const Point& x, const Point& origin) { return vec3((x - origin).data()); }

JPH::Ref<JPH::Shape> made(const JPH::ShapeSettings& settings) {
  const JPH::ShapeSettings::ShapeResult result = settings.Create();
  if (result.HasError()) throw std::runtime_error("Jolt: " + std::string(result.GetError().c_str()));
  return result.Get();
}

/// A copy of vertices and faces with the constraints that the engine makes from the faces.
Shared created(const Shared& from, const Shared::VertexAttributes& attributes, Shared::EBendType bend) {
  Shared copy;
  copy.mVertices = from.mVertices;
  copy.mFaces = from.mFaces;
  copy.CreateConstraints(&attributes, 1, bend);
  return copy;
}

/// Adds the engine's edge constraints in the engine's order, which affects convergence. An edge with a spring of the
/// scene gets the spring's compliance, and a diagonal without a spring is removed.
void add_edges(const ClothbenchScene& s, Shared& to) {
  constexpr float kDiagonal = 2;  // marks the engine's diagonals
  std::map<peer::Pair, Shared::Edge> springs;
  for (const peer::Spring& p : peer::springs(s)) {
    if (p.kind == peer::Kind::Bend || !(p.stiffness_N_per_m > 0)) continue;
    const double k = p.stiffness_N_per_m;
    Shared::Edge e(p.a, p.b, std::isinf(k) ? 0.0F : static_cast<float>(1 / k));
    e.mRestLength = static_cast<float>(p.rest_m);
    springs[peer::pair(p.a, p.b)] = e;
  }
  for (const Shared::Edge& e :
       created(to, {0.0F, kDiagonal, kBendCompliance}, Shared::EBendType::Distance).mEdgeConstraints) {
    const auto at = springs.find(peer::pair(e.mVertex[0], e.mVertex[1]));
    if (at != springs.end()) {
      to.mEdgeConstraints.push_back(at->second);
      springs.erase(at);
    } else if (e.mCompliance == kBendCompliance) {
      to.mEdgeConstraints.push_back(e);
    }
  }
  for (const auto& [vertices, e] : springs) to.mEdgeConstraints.push_back(e);
}

/// The sheet at rest. Long-range attachments lead only to pins, because attached vertices can be released.
JPH::Ref<Shared> shared_settings(const ClothbenchScene& s) {
  JPH::Ref<Shared> out = new Shared;
  const std::vector<double> inverse_mass = peer::inverse_masses(s);
  for (std::uint32_t v = 0; v < s.vertex_count; ++v) {
    JPH::Float3 at;
    vec3(s.rest_position_m + 3 * v).StoreFloat3(&at);
    out->mVertices.emplace_back(at, JPH::Float3(0, 0, 0), static_cast<float>(inverse_mass[v]));
  }
  for (std::uint32_t t = 0; t < s.triangle_count; ++t)
    out->AddFace({s.triangles[3 * t], s.triangles[3 * t + 1], s.triangles[3 * t + 2]});
  add_edges(s, *out);
  out->CalculateBendConstraintConstants();
  if (s.pin_count > 0)
    out->mLRAConstraints =
        created(*out, {0.0F, 0.0F, FLT_MAX, Shared::ELRAType::EuclideanDistance}, Shared::EBendType::None)
            .mLRAConstraints;
  out->Optimize();
  return out;
}

struct Layers : JPH::BroadPhaseLayerInterfaceTable {
  Layers() : JPH::BroadPhaseLayerInterfaceTable(2, 2) {
    for (const JPH::ObjectLayer layer : {kCloth, kObstacle})
      MapObjectToBroadPhaseLayer(layer, JPH::BroadPhaseLayer(static_cast<JPH::uint8>(layer)));
  }
};

struct Overlaps : JPH::ObjectLayerPairFilterTable {
  Overlaps() : JPH::ObjectLayerPairFilterTable(2) { EnableCollision(kCloth, kObstacle); }
};

/// The engine's default is the geometric mean of two bodies' coefficients; a scene has one coefficient per pair.
float pair_friction(const JPH::Body& a, const JPH::SubShapeID&, const JPH::Body& b, const JPH::SubShapeID&) {
  return a.IsSoftBody() ? b.GetFriction() : a.GetFriction();
}

/// One simulation; members in the order of construction.
struct World {
  Layers layers;
  Overlaps overlaps;
  JPH::ObjectVsBroadPhaseLayerFilterTable broad_phase{layers, 2, overlaps, 2};
  JPH::TempAllocatorImplWithMallocFallback memory{4 << 20};
  JPH::JobSystemSingleThreaded jobs{JPH::cMaxPhysicsJobs};
  JPH::PhysicsSystem system;
  JPH::Body* cloth = nullptr;
  std::vector<std::vector<JPH::BodyID>> bodies;  ///< of each collider

  World() {
    system.Init(1024, 0, 1024, 1024, layers, broad_phase, overlaps);
    system.SetCombineFriction(pair_friction);
  }
  JPH::Array<JPH::SoftBodyVertex>& vertices() const {
    return static_cast<JPH::SoftBodyMotionProperties*>(cloth->GetMotionProperties())->GetVertices();
  }
};

/// Middle of a capsule, and the rotation from y to its axis.
struct CapsulePose {
  Vec3 middle;
  Quat turn;
  float half_length;
};

CapsulePose pose_of(const double* capsule, const Point& origin) {
  const Vec3 a = to_engine(peer::point(capsule, 0), origin), b = to_engine(peer::point(capsule, 1), origin);
  const Vec3 half = 0.5F * (b - a);
  const float l = half.Length();
  return {0.5F * (a + b), l > 0 ? Quat::sFromTo(Vec3::sAxisY(), half / l) : Quat::sIdentity(), l};
}

struct Settings {
  int iterations, collision_steps;
  double collision_margin_m;
  explicit Settings(const double* v)
      : iterations(static_cast<int>(v[0])), collision_steps(static_cast<int>(v[1])), collision_margin_m(v[2]) {}
};

std::string obstacle(const Settings& s, const ClothbenchScene&) {
  return s.iterations < 1 || s.collision_steps < 1 ? "Jolt needs at least one iteration and one collision step" : "";
}

class Solver : public peer::Adapter {
 public:
  Solver(const Settings& settings, const ClothbenchScene& s) : Adapter("update", s), settings_(settings) {
    static const bool once = [] {
      JPH::RegisterDefaultAllocator();
      JPH::Factory::sInstance = new JPH::Factory;
      JPH::RegisterTypes();
      return true;
    }();
    (void)once;
    shared_ = shared_settings(s);
    restart(peer::start_of(s));
  }

  std::int32_t step(const ClothbenchFrame& frame) {
    move_grips(frame);
    move_colliders(frame);
    const JPH::EPhysicsUpdateError error = world_->system.Update(
        static_cast<float>(frame.dt_s), settings_.collision_steps, &world_->memory, &world_->jobs);
    if (error != JPH::EPhysicsUpdateError::None) return CLOTHBENCH_DIVERGED;
    for (const JPH::SoftBodyVertex& v : world_->vertices())
      if (!std::isfinite(v.mPosition.Dot(Vec3::sReplicate(1)))) return CLOTHBENCH_NOT_FINITE;
    return CLOTHBENCH_OK;
  }

  void read(double* position_m, double* velocity_m_per_s) const {
    const JPH::Array<JPH::SoftBodyVertex>& vertices = world_->vertices();
    for (std::uint32_t v = 0; v < scene.vertex_count; ++v)
      for (unsigned k = 0; k < 3; ++k) {
        position_m[3 * v + k] = origin[k] + static_cast<double>(vertices[v].mPosition[k]);
        velocity_m_per_s[3 * v + k] = static_cast<double>(vertices[v].mVelocity[k]);
      }
  }

  /// Contact offset [m]: the engine has one radius for all vertices, so it is the scene's largest margin.
  double margin_m(std::uint32_t = 0) const {
    double largest = 0;
    for (std::uint32_t k = 0; k < scene.collider_count; ++k)
      largest = std::max(largest, peer::margin(settings_.collision_margin_m, scene.colliders[k]));
    return largest;
  }

  /// The constraints of the shared settings already have rest lengths, so the vertices can be moved to the start.
  void restart(const ClothbenchRestart& start) {
    world_ = std::make_unique<World>();
    world_->system.SetGravity(vec3(scene.gravity_m_per_s2));
    world_->bodies.resize(scene.collider_count);
    for (std::uint32_t k = 0; k < scene.collider_count; ++k) add_collider(k, start.poses[k]);
    for (std::uint32_t v = 0; v < scene.vertex_count; ++v) {
      Shared::Vertex& vertex = shared_->mVertices[v];
      to_engine(peer::point(start.position_m, v), origin).StoreFloat3(&vertex.mPosition);
      if (vertex.mInvMass > 0) vec3(start.velocity_m_per_s + 3 * v).StoreFloat3(&vertex.mVelocity);
    }
    JPH::SoftBodyCreationSettings body(shared_, JPH::RVec3::sZero(), Quat::sIdentity(), kCloth);
    body.mNumIterations = static_cast<JPH::uint32>(settings_.iterations);
    body.mLinearDamping = static_cast<float>(scene.damping_per_s);
    body.mVertexRadius = static_cast<float>(margin_m());
    body.mUpdatePosition = false;
    body.mAllowSleeping = false;
    JPH::BodyInterface& bodies = world_->system.GetBodyInterfaceNoLock();
    world_->cloth = bodies.CreateSoftBody(body);
    if (world_->cloth == nullptr) throw std::runtime_error("Jolt: CreateSoftBody failed");
    bodies.AddBody(world_->cloth->GetID(), JPH::EActivation::Activate);
  }

 private:
  void add_body(std::uint32_t collider, const JPH::Shape* shape, Vec3 at, Quat turn, EMotionType motion) {
    JPH::BodyCreationSettings settings(shape, at, turn, motion, kObstacle);
    settings.mFriction = static_cast<float>(scene.colliders[collider].friction);
    const JPH::BodyID id = world_->system.GetBodyInterfaceNoLock().CreateAndAddBody(
        settings, motion == EMotionType::Static ? JPH::EActivation::DontActivate : JPH::EActivation::Activate);
    if (id.IsInvalid()) throw std::runtime_error("Jolt: no room for another body");
    world_->bodies[collider].push_back(id);
  }

  /// Spheres, boxes, planes and meshes are static bodies, and each capsule a kinematic one.
  void add_collider(std::uint32_t k, const ClothbenchPose& pose) {
    const ClothbenchCollider& c = scene.colliders[k];
    const Vec3 middle = to_engine(peer::point(c.center_m, 0), origin);
    const auto fixed = [&](const JPH::ShapeSettings& settings, Vec3 at, Quat turn) {
      add_body(k, made(settings), at, turn, EMotionType::Static);
    };
    if (c.shape == CLOTHBENCH_SHAPE_SPHERE)
      fixed(JPH::SphereShapeSettings(static_cast<float>(c.radius_m)), middle, Quat::sIdentity());
    if (c.shape == CLOTHBENCH_SHAPE_PLANE)
      fixed(JPH::PlaneShapeSettings(JPH::Plane(vec3(c.normal), 0.0F)), middle, Quat::sIdentity());
    if (c.shape == CLOTHBENCH_SHAPE_BOX) {
      const JPH::Mat44 axes(JPH::Vec4(vec3(c.axes), 0), JPH::Vec4(vec3(c.axes + 3), 0), JPH::Vec4(vec3(c.axes + 6), 0),
                            JPH::Vec4(0, 0, 0, 1));
      fixed(JPH::BoxShapeSettings(vec3(c.half_extent_m), 0.0F), middle, axes.GetQuaternion().Normalized());
    }
    if (c.shape == CLOTHBENCH_SHAPE_MESH)
      add_body(k, mesh(c, pose.vertices_m), Vec3::sZero(), Quat::sIdentity(), EMotionType::Static);
    for (std::uint32_t n = 0; c.shape == CLOTHBENCH_SHAPE_CAPSULES && n < c.capsule_count; ++n) {
      const CapsulePose at = pose_of(pose.capsules + 7 * n, origin);
      const auto radius = static_cast<float>(pose.capsules[7 * n + 6]);
      add_body(k,
               at.half_length > 0 ? made(JPH::CapsuleShapeSettings(at.half_length, radius))
                                  : made(JPH::SphereShapeSettings(radius)),
               at.middle, at.turn, EMotionType::Kinematic);
    }
  }

  JPH::Ref<JPH::Shape> mesh(const ClothbenchCollider& c, const double* vertices_m) const {
    JPH::VertexList vertices(c.vertex_count);
    JPH::IndexedTriangleList triangles;
    for (std::uint32_t v = 0; v < c.vertex_count; ++v)
      to_engine(peer::point(vertices_m, v), origin).StoreFloat3(&vertices[v]);
    for (std::uint32_t t = 0; t < c.triangle_count; ++t)
      triangles.emplace_back(c.triangles[3 * t], c.triangles[3 * t + 1], c.triangles[3 * t + 2], 0);
    JPH::MeshShapeSettings settings(std::move(vertices), std::move(triangles));
    if (c.moves != 0) settings.mBuildQuality = JPH::MeshShapeSettings::EBuildQuality::FavorBuildSpeed;
    return made(settings);
  }

  /// Moves kinematic colliders to their poses at the end of the frame. Meshes get a new shape: the engine's are rigid.
  void move_colliders(const ClothbenchFrame& frame) {
    JPH::BodyInterface& bodies = world_->system.GetBodyInterfaceNoLock();
    for (std::uint32_t k = 0; k < scene.collider_count; ++k) {
      const ClothbenchCollider& c = scene.colliders[k];
      const std::vector<JPH::BodyID>& ids = world_->bodies[k];
      if (c.moves == 0) continue;
      if (c.shape == CLOTHBENCH_SHAPE_MESH)
        bodies.SetShape(ids.front(), mesh(c, frame.poses[k].vertices_m), false, JPH::EActivation::DontActivate);
      for (std::uint32_t n = 0; n < c.capsule_count; ++n) {
        const CapsulePose at = pose_of(frame.poses[k].capsules + 7 * n, origin);
        if (frame.collider_teleports != nullptr && frame.collider_teleports[k] != 0)
          bodies.SetPositionRotationAndVelocity(ids[n], at.middle, at.turn, Vec3::sZero(), Vec3::sZero());
        else
          bodies.MoveKinematic(ids[n], at.middle, at.turn, static_cast<float>(frame.dt_s));
      }
    }
  }

  /// Attached vertices are kinematic: inverse mass 0, and the velocity that brings them to their end position.
  void move_grips(const ClothbenchFrame& frame) {
    for (std::uint32_t k = 0; k < scene.grip_count; ++k) {
      const std::uint32_t v = scene.grips[k];
      JPH::SoftBodyVertex& vertex = world_->vertices()[v];
      const bool attached = frame.grip_held == nullptr || frame.grip_held[k] != 0;
      vertex.mInvMass = attached ? 0.0F : static_cast<float>(1 / scene.mass_kg[v]);
      if (!attached) continue;
      const double* end = frame.grip_position_m == nullptr ? scene.position_m + 3 * v : frame.grip_position_m + 3 * k;
      const Vec3 target = to_engine(peer::point(end, 0), origin);
      if (frame.grip_teleports != nullptr && frame.grip_teleports[k] != 0) vertex.mPosition = target;
      vertex.mVelocity = (target - vertex.mPosition) / static_cast<float>(frame.dt_s);
    }
  }

  Settings settings_;
  JPH::Ref<Shared> shared_;
  std::unique_ptr<World> world_;
};

/// The engine's integrator: v = (v + g h) (1 - c h), x += h v.
double free_fall_m(const double* values, double dt_s, double gravity, double velocity, double damping,
                   std::int32_t frames) {
  const Settings settings(values);
  const int n = settings.iterations * settings.collision_steps;
  const double h = dt_s / n, kept = std::max(0.0, 1 - damping * h);
  return peer::fallen_m(std::int64_t{frames} * n, h, velocity, [=](double v) { return kept * (v + h * gravity); });
}

const ClothbenchSetting kSettings[] = {
    {"iterations",
     "iterations per collision step (mNumIterations): each is a time step with one pass over the constraints", 5, 1},
    {"substeps", "collision steps per frame (the second argument of PhysicsSystem::Update)", 1, 1},
    {"collision_margin_m", "radius of vertices; 0: the largest margin of the scene", 0, 0}};

}  // namespace
}  // namespace clothbench::jolt

CLOTHBENCH_PEER(clothbench::jolt, "jolt", "Jolt Physics", "float32", "Jolt Physics' soft bodies on one CPU core")
