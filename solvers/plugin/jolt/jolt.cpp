// Jolt's soft bodies behind clothbench_plugin.h.

// clang-format off: Jolt.h comes before every other header of the engine.
#include <Jolt/Jolt.h>
// clang-format on

#include <Jolt/Core/Factory.h>
#include <Jolt/Core/JobSystemSingleThreaded.h>
#include <Jolt/Core/TempAllocator.h>
#include <Jolt/Physics/Body/BodyCreationSettings.h>
#include <Jolt/Physics/Collision/BroadPhase/BroadPhaseLayerInterfaceTable.h>
#include <Jolt/Physics/Collision/Shape/BoxShape.h>
#include <Jolt/Physics/Collision/Shape/CapsuleShape.h>
#include <Jolt/Physics/Collision/Shape/MeshShape.h>
#include <Jolt/Physics/Collision/Shape/PlaneShape.h>
#include <Jolt/Physics/Collision/Shape/SphereShape.h>
#include <Jolt/Physics/PhysicsSystem.h>
#include <Jolt/Physics/SoftBody/SoftBodyCreationSettings.h>
#include <Jolt/Physics/SoftBody/SoftBodyMotionProperties.h>
#include <Jolt/RegisterTypes.h>

#include "peer.hpp"

namespace clothbench::jolt {
namespace {

using JPH::EMotionType, JPH::Quat, JPH::Vec3, peer::Point;
using Shared = JPH::SoftBodySharedSettings;
using ShapeRef = JPH::RefConst<JPH::Shape>;

/// Compliance of bend constraints [m/N]. With 1e-5, as in the engine's samples, an inextensible 64 x 64 sheet tears.
constexpr float kBendCompliance = 1e-2F;

struct Settings {
  double iterations, collision_steps, margin_m;
  int steps(double) const { return static_cast<int>(iterations * collision_steps); }
};

const ClothbenchSetting kSettings[] = {
    {"iterations", "time steps per collision step, each with one pass over the constraints (mNumIterations)", 5, 1},
    {"substeps", "collision steps per frame (the second argument of PhysicsSystem::Update)", 1, 1},
    {"collision_margin_m", "radius of vertices; 0: the largest margin of the scene", 0, 0}};

Vec3 vec3(const double* x) { return {static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])}; }
JPH::Float3 float3(Vec3 x) { return {x.GetX(), x.GetY(), x.GetZ()}; }

/// The sheet at rest, with the engine's edge constraints in the engine's order, which affects convergence. An edge with
/// a spring of the scene gets the spring's compliance, and a diagonal without a spring is removed. Long-range
/// attachments lead only to pins, because attached vertices can be released.
JPH::Ref<Shared> shared_settings(const ClothbenchScene& s) {
  constexpr float kDiagonal = 2;  // marks the engine's diagonals
  JPH::Ref<Shared> out = new Shared;
  const std::vector<double> inverse_mass = peer::inverse_masses(s);
  for (std::uint32_t v = 0; v < s.vertex_count; ++v)
    out->mVertices.emplace_back(float3(vec3(s.rest_position_m + 3 * v)), JPH::Float3(0, 0, 0),
                                static_cast<float>(inverse_mass[v]));
  for (const std::uint32_t* t = s.triangles; t < s.triangles + 3 * s.triangle_count; t += 3)
    out->AddFace({t[0], t[1], t[2]});
  const JPH::Ref<Shared> edges = out->Clone(), tethers = out->Clone();
  const Shared::VertexAttributes edge(0.0F, kDiagonal, kBendCompliance),
      tether(0.0F, 0.0F, FLT_MAX, Shared::ELRAType::EuclideanDistance);
  edges->CreateConstraints(&edge, 1, Shared::EBendType::Distance);
  tethers->CreateConstraints(&tether, 1, Shared::EBendType::None);
  out->mLRAConstraints = tethers->mLRAConstraints;
  std::map<peer::Pair, ClothbenchEdge> springs = peer::springs(s, false);
  const auto add = [&](const ClothbenchEdge& e) {
    out->mEdgeConstraints.emplace_back(e.a, e.b, static_cast<float>(1 / e.spring_N_per_m));
    out->mEdgeConstraints.back().mRestLength = static_cast<float>(e.rest_m);
  };
  for (const Shared::Edge& e : edges->mEdgeConstraints) {
    const auto at = springs.find(peer::pair(e.mVertex[0], e.mVertex[1]));
    if (at != springs.end()) {
      add(at->second);
      springs.erase(at);
    } else if (e.mCompliance == kBendCompliance) {
      out->mEdgeConstraints.push_back(e);
    }
  }
  for (const auto& [vertices, e] : springs) add(e);
  out->Optimize();
  return out;
}

/// One simulation; members in the order of construction.
struct World {
  JPH::BroadPhaseLayerInterfaceTable layers{1, 1};
  JPH::ObjectVsBroadPhaseLayerFilter broad_phase;
  JPH::ObjectLayerPairFilter pairs;
  JPH::TempAllocatorImplWithMallocFallback memory{4 << 20};
  JPH::JobSystemSingleThreaded jobs{JPH::cMaxPhysicsJobs};
  JPH::PhysicsSystem system;
  JPH::Body* cloth = nullptr;
  std::vector<std::vector<JPH::BodyID>> bodies;  ///< of each collider
  JPH::BodyInterface& interface() { return system.GetBodyInterfaceNoLock(); }
  JPH::Array<JPH::SoftBodyVertex>& vertices() const {
    return static_cast<JPH::SoftBodyMotionProperties*>(cloth->GetMotionProperties())->GetVertices();
  }
};

class Solver : public peer::Adapter<Settings> {
 public:
  Solver(const Settings& given, const ClothbenchScene& s)
      : Adapter("update", given, s), origin_(peer::centre(peer::points(s.position_m, s.vertex_count))) {
    if (JPH::Factory::sInstance == nullptr) {
      JPH::RegisterDefaultAllocator();
      JPH::Factory::sInstance = new JPH::Factory;
      JPH::RegisterTypes();
    }
    shared_ = shared_settings(s);
    restart(peer::start_of(s));
  }

  std::int32_t step(const ClothbenchFrame& frame) {
    move(frame);
    const JPH::EPhysicsUpdateError error = world_->system.Update(
        static_cast<float>(frame.dt_s), static_cast<int>(settings.collision_steps), &world_->memory, &world_->jobs);
    return error == JPH::EPhysicsUpdateError::None ? CLOTHBENCH_OK : CLOTHBENCH_DIVERGED;
  }

  void read(double* position_m, double* velocity_m_per_s) const {
    const JPH::Array<JPH::SoftBodyVertex>& vertices = world_->vertices();
    for (std::uint32_t k = 0; k < 3 * scene.vertex_count; ++k) {
      position_m[k] = origin_[k % 3] + static_cast<double>(vertices[k / 3].mPosition[k % 3]);
      velocity_m_per_s[k] = static_cast<double>(vertices[k / 3].mVelocity[k % 3]);
    }
  }

  /// Contact offset [m]: the engine has one radius for all vertices, so it is the scene's largest margin.
  double margin_m(std::uint32_t = 0) const { return peer::largest_margin(settings.margin_m, scene); }

  /// The constraints of the shared settings already have rest lengths, so the vertices can be moved to the start.
  void restart(const ClothbenchRestart& start) {
    world_ = std::make_unique<World>();
    world_->system.Init(1024, 0, 1024, 1024, world_->layers, world_->broad_phase, world_->pairs);
    // The engine's default is the geometric mean of two bodies' coefficients; a scene has one coefficient per pair.
    world_->system.SetCombineFriction([](const JPH::Body& a, const JPH::SubShapeID&, const JPH::Body& b,
                                         const JPH::SubShapeID&) { return (a.IsSoftBody() ? b : a).GetFriction(); });
    world_->system.SetGravity(vec3(scene.gravity_m_per_s2));
    world_->bodies.resize(scene.collider_count);
    for (std::uint32_t k = 0; k < scene.collider_count; ++k) add_collider(k, start.poses[k]);
    for (std::uint32_t v = 0; v < scene.vertex_count; ++v) {
      Shared::Vertex& vertex = shared_->mVertices[v];
      vertex.mPosition = float3(to_engine(start.position_m + 3 * v));
      if (vertex.mInvMass > 0) vertex.mVelocity = float3(vec3(start.velocity_m_per_s + 3 * v));
    }
    JPH::SoftBodyCreationSettings body(shared_, JPH::RVec3::sZero(), Quat::sIdentity(), 0);
    body.mNumIterations = static_cast<JPH::uint32>(settings.iterations);
    body.mLinearDamping = static_cast<float>(scene.damping_per_s);
    body.mVertexRadius = static_cast<float>(margin_m());
    body.mUpdatePosition = body.mAllowSleeping = false;
    world_->cloth = world_->interface().CreateSoftBody(body);
    if (world_->cloth == nullptr) throw std::runtime_error("Jolt: CreateSoftBody failed");
    world_->interface().AddBody(world_->cloth->GetID(), JPH::EActivation::Activate);
  }

  /// The engine's integrator.
  static double next_velocity(double velocity, double h, double gravity, double damping) {
    return std::max(0.0, 1 - damping * h) * (velocity + h * gravity);
  }

 private:
  /// Converts a point [m] to the engine's float32 coordinates.
  Vec3 to_engine(const double* x) const { return vec3((peer::point(x, 0) - origin_).data()); }

  /// Middle of a capsule, the rotation from y to its axis, and half its length.
  std::tuple<Vec3, Quat, float> pose_of(const double* capsule) const {
    const Vec3 a = to_engine(capsule), b = to_engine(capsule + 3), half = 0.5F * (b - a);
    return {0.5F * (a + b), Quat::sFromTo(Vec3::sAxisY(), half.NormalizedOr(Vec3::sZero())), half.Length()};
  }

  void add_body(std::uint32_t collider, const ShapeRef& shape, Vec3 at, Quat turn = Quat::sIdentity(),
                EMotionType motion = EMotionType::Static) {
    JPH::BodyCreationSettings body(shape, at, turn, motion, 0);
    body.mFriction = static_cast<float>(scene.colliders[collider].friction);
    const JPH::BodyID id = world_->interface().CreateAndAddBody(body, JPH::EActivation::Activate);
    if (id.IsInvalid()) throw std::runtime_error("Jolt: no room for another body");
    world_->bodies[collider].push_back(id);
  }

  /// Spheres, boxes, planes and meshes are static bodies, and each capsule a kinematic one.
  void add_collider(std::uint32_t k, const ClothbenchPose& pose) {
    const ClothbenchCollider& c = scene.colliders[k];
    const Vec3 middle = to_engine(c.center_m);
    if (c.shape == CLOTHBENCH_SHAPE_SPHERE) add_body(k, new JPH::SphereShape(static_cast<float>(c.radius_m)), middle);
    if (c.shape == CLOTHBENCH_SHAPE_PLANE) add_body(k, new JPH::PlaneShape(JPH::Plane(vec3(c.normal), 0)), middle);
    if (c.shape == CLOTHBENCH_SHAPE_BOX) {
      const JPH::Vec4 x(vec3(c.axes), 0), y(vec3(c.axes + 3), 0), z(vec3(c.axes + 6), 0);
      const Quat turn = JPH::Mat44(x, y, z, JPH::Vec4(0, 0, 0, 1)).GetQuaternion().Normalized();
      add_body(k, new JPH::BoxShape(vec3(c.half_extent_m), 0), middle, turn);
    }
    if (c.shape == CLOTHBENCH_SHAPE_MESH) add_body(k, mesh(c, pose.vertices_m), Vec3::sZero());
    for (const double* n = pose.capsules; n < pose.capsules + 7 * c.capsule_count; n += 7) {
      const auto [at, turn, half_length] = pose_of(n);
      const auto* shape = new JPH::CapsuleShape(std::max(half_length, 1e-9F), static_cast<float>(n[6]));
      add_body(k, shape, at, turn, EMotionType::Kinematic);
    }
  }

  ShapeRef mesh(const ClothbenchCollider& c, const double* vertices_m) const {
    JPH::VertexList vertices;
    JPH::IndexedTriangleList triangles;
    for (std::uint32_t v = 0; v < c.vertex_count; ++v) vertices.push_back(float3(to_engine(vertices_m + 3 * v)));
    for (const std::uint32_t* t = c.triangles; t < c.triangles + 3 * c.triangle_count; t += 3)
      triangles.emplace_back(t[0], t[1], t[2], 0);
    JPH::MeshShapeSettings mesh(std::move(vertices), std::move(triangles));
    if (c.moves != 0) mesh.mBuildQuality = JPH::MeshShapeSettings::EBuildQuality::FavorBuildSpeed;
    const JPH::ShapeSettings::ShapeResult made = mesh.Create();
    if (made.HasError()) throw std::runtime_error("Jolt: " + std::string(made.GetError().c_str()));
    return made.Get();
  }

  /// Moves kinematic colliders to their poses at the end of the frame; a mesh gets a new shape, because the engine's
  /// are rigid. Attached vertices are kinematic: inverse mass 0, and the velocity that brings them to their end
  /// position.
  void move(const ClothbenchFrame& frame) {
    const auto dt_s = static_cast<float>(frame.dt_s);
    for (std::uint32_t k = 0; k < scene.collider_count; ++k) {
      const ClothbenchCollider& c = scene.colliders[k];
      const std::vector<JPH::BodyID>& ids = world_->bodies[k];
      if (c.moves != 0 && c.shape == CLOTHBENCH_SHAPE_MESH)
        world_->interface().SetShape(ids.front(), mesh(c, frame.poses[k].vertices_m), false,
                                     JPH::EActivation::DontActivate);
      for (std::uint32_t n = 0; n < c.capsule_count; ++n) {
        const auto [at, turn, half_length] = pose_of(frame.poses[k].capsules + 7 * n);
        if (peer::teleports(frame.collider_teleports, k))
          world_->interface().SetPositionRotationAndVelocity(ids[n], at, turn, Vec3::sZero(), Vec3::sZero());
        else
          world_->interface().MoveKinematic(ids[n], at, turn, dt_s);
      }
    }
    for (std::uint32_t k = 0; k < scene.grip_count; ++k) {
      JPH::SoftBodyVertex& vertex = world_->vertices()[scene.grips[k]];
      const bool attached = frame.grip_held[k] != 0;
      vertex.mInvMass = attached ? 0.0F : static_cast<float>(1 / scene.mass_kg[scene.grips[k]]);
      if (!attached) continue;
      const Vec3 target = to_engine(frame.grip_position_m + 3 * k);
      if (peer::teleports(frame.grip_teleports, k)) vertex.mPosition = target;
      vertex.mVelocity = (target - vertex.mPosition) / dt_s;
    }
  }

  Point origin_;  ///< origin of the engine's coordinates [m]
  JPH::Ref<Shared> shared_;
  std::unique_ptr<World> world_;
};

}  // namespace
}  // namespace clothbench::jolt

CLOTHBENCH_PEER(clothbench::jolt, "jolt", "Jolt Physics", "float32", "Jolt Physics' soft bodies on one CPU core")
