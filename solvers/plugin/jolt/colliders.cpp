#include "jolt/colliders.hpp"

#include <stdexcept>

namespace clothbench::jolt {
namespace {

using JPH::Quat;
using JPH::Vec3;
using peer::Point;

/// Half the side of the square that bounds a plane [m]: the engine's default.
constexpr float kPlane_m = JPH::PlaneShapeSettings::cDefaultHalfExtent;

JPH::Ref<JPH::Shape> made(const JPH::ShapeSettings& settings) {
  const JPH::ShapeSettings::ShapeResult result = settings.Create();
  if (result.HasError()) throw std::runtime_error("Jolt: " + std::string(result.GetError().c_str()));
  return result.Get();
}

Vec3 vec3(const double* x) { return {static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])}; }

/// Where a capsule lies: its middle, and the turn that takes y to its axis.
struct Place {
  Vec3 middle;
  Quat turn;
  float half_length;
};

Place place(const double* capsule, const Point& origin) {
  const Vec3 a = to_engine(peer::point(capsule, 0), origin), b = to_engine(peer::point(capsule, 1), origin);
  const Vec3 half = 0.5F * (b - a);
  const float l = half.Length();
  return {0.5F * (a + b), l > 0 ? Quat::sFromTo(Vec3::sAxisY(), half / l) : Quat::sIdentity(), l};
}

}  // namespace

Colliders::Colliders(const ClothbenchScene& s, const Point& origin)
    : scene_(s), origin_(origin), bodies_(s.collider_count) {}

void Colliders::add_body(JPH::PhysicsSystem& system, const ClothbenchCollider& c, const JPH::Shape* shape, Vec3 at,
                         Quat turn, JPH::EMotionType motion) {
  JPH::BodyCreationSettings settings(shape, at, turn, motion, kObstacle);
  settings.mFriction = static_cast<float>(c.friction);
  const JPH::BodyID id = system.GetBodyInterfaceNoLock().CreateAndAddBody(
      settings, motion == JPH::EMotionType::Static ? JPH::EActivation::DontActivate : JPH::EActivation::Activate);
  if (id.IsInvalid()) throw std::runtime_error("Jolt: no room for another body");
  bodies_[static_cast<std::size_t>(&c - scene_.colliders)].push_back(id);
}

void Colliders::add(JPH::PhysicsSystem& system, const ClothbenchPose* poses) {
  for (std::vector<JPH::BodyID>& ids : bodies_) ids.clear();
  for (std::uint32_t k = 0; k < scene_.collider_count; ++k) {
    const ClothbenchCollider& c = scene_.colliders[k];
    const Vec3 middle = to_engine(peer::point(c.center_m, 0), origin_);
    const auto fixed = [&](const JPH::ShapeSettings& settings, Vec3 at, Quat turn) {
      add_body(system, c, made(settings), at, turn, JPH::EMotionType::Static);
    };
    if (c.shape == CLOTHBENCH_SHAPE_SPHERE)
      fixed(JPH::SphereShapeSettings(static_cast<float>(c.radius_m)), middle, Quat::sIdentity());
    if (c.shape == CLOTHBENCH_SHAPE_PLANE)
      fixed(JPH::PlaneShapeSettings(JPH::Plane(vec3(c.normal), 0.0F), nullptr, kPlane_m), middle, Quat::sIdentity());
    if (c.shape == CLOTHBENCH_SHAPE_BOX) {
      const JPH::Mat44 axes(JPH::Vec4(vec3(c.axes), 0), JPH::Vec4(vec3(c.axes + 3), 0), JPH::Vec4(vec3(c.axes + 6), 0),
                            JPH::Vec4(0, 0, 0, 1));
      fixed(JPH::BoxShapeSettings(vec3(c.half_extent_m), 0.0F), middle, axes.GetQuaternion().Normalized());
    }
    if (c.shape == CLOTHBENCH_SHAPE_MESH)
      add_body(system, c, mesh(c, poses[k].vertices_m), Vec3::sZero(), Quat::sIdentity(), JPH::EMotionType::Static);
    if (c.shape == CLOTHBENCH_SHAPE_CAPSULES) add_capsules(system, c, poses[k].capsules);
  }
}

void Colliders::add_capsules(JPH::PhysicsSystem& system, const ClothbenchCollider& c, const double* capsules) {
  for (std::uint32_t n = 0; n < c.capsule_count; ++n) {
    const Place at = place(capsules + 7 * n, origin_);
    const auto radius = static_cast<float>(capsules[7 * n + 6]);
    const JPH::Ref<JPH::Shape> shape = at.half_length > 0 ? made(JPH::CapsuleShapeSettings(at.half_length, radius))
                                                          : made(JPH::SphereShapeSettings(radius));
    add_body(system, c, shape, at.middle, at.turn, JPH::EMotionType::Kinematic);
  }
}

JPH::Ref<JPH::Shape> Colliders::mesh(const ClothbenchCollider& c, const double* vertices_m) const {
  JPH::VertexList vertices;
  JPH::IndexedTriangleList triangles;
  for (std::uint32_t v = 0; v < c.vertex_count; ++v) {
    JPH::Float3 at;
    to_engine(peer::point(vertices_m, v), origin_).StoreFloat3(&at);
    vertices.push_back(at);
  }
  for (std::uint32_t t = 0; t < c.triangle_count; ++t)
    triangles.emplace_back(c.triangles[3 * t], c.triangles[3 * t + 1], c.triangles[3 * t + 2], 0);
  JPH::MeshShapeSettings settings(std::move(vertices), std::move(triangles));
  if (c.moves != 0) settings.mBuildQuality = JPH::MeshShapeSettings::EBuildQuality::FavorBuildSpeed;
  return made(settings);
}

void Colliders::move(JPH::PhysicsSystem& system, const ClothbenchFrame& frame) {
  JPH::BodyInterface& bodies = system.GetBodyInterfaceNoLock();
  for (std::uint32_t k = 0; k < scene_.collider_count; ++k) {
    const ClothbenchCollider& c = scene_.colliders[k];
    if (c.moves == 0) continue;
    if (c.shape == CLOTHBENCH_SHAPE_MESH)
      bodies.SetShape(bodies_[k].front(), mesh(c, frame.poses[k].vertices_m), false, JPH::EActivation::DontActivate);
    for (std::uint32_t n = 0; n < c.capsule_count; ++n) {
      const Place at = place(frame.poses[k].capsules + 7 * n, origin_);
      if (frame.collider_teleports != nullptr && frame.collider_teleports[k] != 0)
        bodies.SetPositionRotationAndVelocity(bodies_[k][n], at.middle, at.turn, Vec3::sZero(), Vec3::sZero());
      else
        bodies.MoveKinematic(bodies_[k][n], at.middle, at.turn, static_cast<float>(frame.dt_s));
    }
  }
}

}  // namespace clothbench::jolt
