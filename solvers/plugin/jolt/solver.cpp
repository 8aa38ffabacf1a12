#include "jolt/solver.hpp"

#include <stdexcept>

namespace clothbench::jolt {
namespace {

void start_engine() {
  static const bool once = [] {
    JPH::RegisterDefaultAllocator();
    JPH::Factory::sInstance = new JPH::Factory;
    JPH::RegisterTypes();
    return true;
  }();
  (void)once;
}

constexpr JPH::BroadPhaseLayer kMoving(0), kFixed(1);

struct Layers : JPH::BroadPhaseLayerInterfaceTable {
  Layers() : JPH::BroadPhaseLayerInterfaceTable(2, 2) {
    MapObjectToBroadPhaseLayer(kCloth, kMoving);
    MapObjectToBroadPhaseLayer(kObstacle, kFixed);
  }
};

struct Meets : JPH::ObjectLayerPairFilterTable {
  Meets() : JPH::ObjectLayerPairFilterTable(2) { EnableCollision(kCloth, kObstacle); }
};

/// The engine would take the geometric mean of two bodies' coefficients; a scene has one for the pair.
float pair_friction(const JPH::Body& a, const JPH::SubShapeID&, const JPH::Body& b, const JPH::SubShapeID&) {
  return a.IsSoftBody() ? b.GetFriction() : a.GetFriction();
}

}  // namespace

/// What belongs to one simulation; members in the order in which they come to be.
struct World {
  Layers layers;
  Meets meets;
  JPH::ObjectVsBroadPhaseLayerFilterTable broad_meets{layers, 2, meets, 2};
  JPH::TempAllocatorImplWithMallocFallback memory{4 << 20};
  JPH::JobSystemSingleThreaded jobs{JPH::cMaxPhysicsJobs};
  JPH::PhysicsSystem system;
  JPH::Body* cloth = nullptr;

  World() {
    system.Init(1024, 0, 1024, 1024, layers, broad_meets, meets);
    system.SetCombineFriction(pair_friction);
  }
  JPH::Array<JPH::SoftBodyVertex>& vertices() const {
    return static_cast<JPH::SoftBodyMotionProperties*>(cloth->GetMotionProperties())->GetVertices();
  }
};

Settings::Settings(const double* v)
    : iterations(static_cast<int>(v[0])),
      collision_steps(static_cast<int>(v[1])),
      attachments(static_cast<Attachments>(static_cast<int>(v[2]))),
      bending{static_cast<BendType>(static_cast<int>(v[3])), v[4]},
      collision_margin_m(v[5]) {}

std::string obstacle(const Settings& settings, const ClothbenchScene&) {
  return settings.iterations < 1 || settings.collision_steps < 1 ? "Jolt takes at least one iteration and one step"
                                                                 : "";
}

Solver::Solver(const Settings& settings, const ClothbenchScene& s)
    : stage(peer::whole_step("update", s)),
      scene_(s),
      settings_(settings),
      origin_(peer::centre(s)),
      colliders_(s, origin_) {
  start_engine();
  shared_ = shared_settings(s, settings.bending, settings.attachments);
  reset();
}

Solver::~Solver() = default;

/// Positions become those of the shared settings once these have their constraints, which hold for the sheet at rest.
void Solver::make_world(const double* position_m, const double* velocity_m_per_s, const ClothbenchPose* poses) {
  world_ = std::make_unique<World>();
  const double* g = scene_.gravity_m_per_s2;
  world_->system.SetGravity({static_cast<float>(g[0]), static_cast<float>(g[1]), static_cast<float>(g[2])});
  colliders_.add(world_->system, poses);
  for (std::uint32_t v = 0; v < scene_.vertex_count; ++v) {
    JPH::SoftBodySharedSettings::Vertex& vertex = shared_->mVertices[v];
    to_engine(peer::point(position_m, v), origin_).StoreFloat3(&vertex.mPosition);
    if (vertex.mInvMass > 0) to_engine(peer::point(velocity_m_per_s, v), {}).StoreFloat3(&vertex.mVelocity);
  }
  JPH::SoftBodyCreationSettings body(shared_, JPH::RVec3::sZero(), JPH::Quat::sIdentity(), kCloth);
  body.mNumIterations = static_cast<JPH::uint32>(settings_.iterations);
  body.mLinearDamping = static_cast<float>(scene_.damping_per_s);
  body.mVertexRadius = static_cast<float>(scene_.collider_count > 0 ? margin_m() : 0);
  body.mUpdatePosition = false;
  body.mAllowSleeping = false;
  JPH::BodyInterface& bodies = world_->system.GetBodyInterfaceNoLock();
  world_->cloth = bodies.CreateSoftBody(body);
  if (world_->cloth == nullptr) throw std::runtime_error("Jolt: CreateSoftBody failed");
  bodies.AddBody(world_->cloth->GetID(), JPH::EActivation::Activate);
}

double Solver::margin_m(std::uint32_t) const {
  double largest = 0;
  for (std::uint32_t k = 0; k < scene_.collider_count; ++k)
    largest = std::max(largest, peer::margin(settings_.collision_margin_m, scene_.colliders[k]));
  return largest;
}

void Solver::reset() { make_world(scene_.position_m, scene_.velocity_m_per_s, scene_.poses); }

void Solver::restart(const ClothbenchRestart& at) { make_world(at.position_m, at.velocity_m_per_s, at.poses); }

/// Held vertices are kinematic: without inverse mass, at the velocity that takes them to the frame's end.
void Solver::hold(const ClothbenchFrame& frame) {
  JPH::Array<JPH::SoftBodyVertex>& vertices = world_->vertices();
  for (std::uint32_t k = 0; k < scene_.grip_count; ++k) {
    const std::uint32_t v = scene_.grips[k];
    JPH::SoftBodyVertex& vertex = vertices[v];
    const bool held = frame.grip_held == nullptr || frame.grip_held[k] != 0;
    vertex.mInvMass = held ? 0.0F : static_cast<float>(1 / scene_.mass_kg[v]);
    if (!held) continue;
    const bool still = frame.grip_position_m == nullptr;
    const peer::Point end = still ? peer::point(scene_.position_m, v) : peer::point(frame.grip_position_m, k);
    const JPH::Vec3 target = to_engine(end, origin_);
    if (frame.grip_teleports != nullptr && frame.grip_teleports[k] != 0) vertex.mPosition = target;
    vertex.mVelocity = (target - vertex.mPosition) / static_cast<float>(frame.dt_s);
  }
}

std::int32_t Solver::step(const ClothbenchFrame& frame) {
  hold(frame);
  colliders_.move(world_->system, frame);
  const JPH::EPhysicsUpdateError error =
      world_->system.Update(static_cast<float>(frame.dt_s), settings_.collision_steps, &world_->memory, &world_->jobs);
  if (error != JPH::EPhysicsUpdateError::None) return CLOTHBENCH_DIVERGED;
  for (const JPH::SoftBodyVertex& v : world_->vertices())
    if (!std::isfinite(v.mPosition.Dot(JPH::Vec3::sReplicate(1)))) return CLOTHBENCH_NOT_FINITE;
  return CLOTHBENCH_OK;
}

void Solver::read(double* position_m, double* velocity_m_per_s) const {
  const JPH::Array<JPH::SoftBodyVertex>& vertices = world_->vertices();
  for (std::uint32_t v = 0; v < scene_.vertex_count; ++v)
    for (unsigned k = 0; k < 3; ++k) {
      position_m[3 * v + k] = origin_[k] + static_cast<double>(vertices[v].mPosition[k]);
      velocity_m_per_s[3 * v + k] = static_cast<double>(vertices[v].mVelocity[k]);
    }
}

}  // namespace clothbench::jolt
