#include <cmath>

#include "bullet-baseline/bullet_solver.hpp"
#include "clothbench/error.hpp"

namespace clothbench::bullet_baseline {
namespace {

/// Half the side of the box whose top represents a plane: larger than any cloth, small enough for float32 distances.
constexpr double kGroundHalf_m = 10;
/// Collision margin of a triangle's body: PyBullet's value for its collision shapes.
constexpr btScalar kTriangleMargin_m = 0.001F;
/// Maximum change of a capsule's length since the start, because its shape is made only once.
constexpr double kLengthTolerance_m = 1e-3;

btVector3 direction(const Capsule& c, const btVector3& otherwise) {
  const btVector3 along = to_bullet(c.b_m) - to_bullet(c.a_m);
  return along.length2() > 0 ? along.normalized() : otherwise;
}

double length(const Capsule& c) { return std::hypot(c.b_m[0] - c.a_m[0], c.b_m[1] - c.a_m[1], c.b_m[2] - c.a_m[2]); }

Capsule between(const Capsule& from, const Capsule& to, double share) {
  Capsule out = from;
  for (std::size_t k = 0; k < 3; ++k) {
    out.a_m[k] += share * (to.a_m[k] - from.a_m[k]);
    out.b_m[k] += share * (to.b_m[k] - from.b_m[k]);
  }
  return out;
}

/// Bullet's capsules lie along y. The new rotation is the last one, followed by the smallest rotation that brings the
/// axis into its new direction. With another choice, a capsule could spin about its axis and drag the cloth along.
btTransform place(const Capsule& c, btQuaternion& turn) {
  const btVector3 was = quatRotate(turn, btVector3(0, 1, 0));
  turn = shortestArcQuat(was, direction(c, was)) * turn;
  turn.normalize();
  return btTransform(turn, (to_bullet(c.a_m) + to_bullet(c.b_m)) / 2);
}

btTransform frame(const btVector3& x, const btVector3& y, const btVector3& z, const btVector3& origin) {
  return btTransform(btMatrix3x3(x.x(), y.x(), z.x(), x.y(), y.y(), z.y(), x.z(), y.z(), z.z()), origin);
}

using Corners = std::array<btVector3, 3>;

Corners corners_of(const ColliderMesh& mesh, std::size_t triangle, const std::vector<double>& x) {
  Corners out;
  for (std::size_t k = 0; k < 3; ++k) out[k] = to_bullet(vertex_at(x, mesh.triangles[triangle][k]));
  return out;
}

/// A coordinate frame at a triangle's centroid that rotates with it. A triangle without area is not rotated.
btTransform place(const Corners& c) {
  const btVector3 middle = (c[0] + c[1] + c[2]) / 3, along = c[1] - c[0], normal = along.cross(c[2] - c[0]);
  if (!(normal.length2() > 0)) return btTransform(btQuaternion::getIdentity(), middle);
  const btVector3 x = along.normalized(), z = normal.normalized(), y = z.cross(x);
  return frame(x, y, z, middle);
}

/// Throws Error if a capsule changes its length, which a rigid body cannot.
void check_lengths(const Scene& scene) {
  for (const FrameMotion& m : scene.motion)
    for (std::size_t c = 0; c < scene.colliders.size(); ++c)
      for (std::size_t k = 0; k < scene.colliders[c].capsules.size(); ++k)
        if (!(std::abs(length(m.colliders[c].capsules[k]) - length(scene.colliders[c].capsules[k])) <=
              kLengthTolerance_m))
          throw Error("collider " + scene.colliders[c].name + ": capsule " + std::to_string(k) +
                      " changes its length by more than 1 mm, which Bullet's rigid bodies cannot");
}

}  // namespace

btVector3 to_bullet(const Vec3& v) {
  return {static_cast<btScalar>(v[0]), static_cast<btScalar>(v[1]), static_cast<btScalar>(v[2])};
}

ColliderBodies::ColliderBodies(const Scene& scene, btDiscreteDynamicsWorld& world)
    : colliders_(scene.colliders), world_(world) {
  check_lengths(scene);
  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    const Collider& c = scene.colliders[k];
    if (c.shape == Collider::Shape::Capsules)
      add_capsules(scene, k);
    else if (c.shape == Collider::Shape::Mesh)
      add_mesh(scene, k);
    else
      add_static(c);
  }
}

ColliderBodies::~ColliderBodies() {
  for (Body& b : bodies_) world_.removeRigidBody(b.body.get());
}

void ColliderBodies::add(std::unique_ptr<btCollisionShape> shape, const btTransform& at, const Collider& c) {
  Body b;
  b.shape = std::move(shape);
  b.motion = std::make_unique<btDefaultMotionState>(at);
  btRigidBody::btRigidBodyConstructionInfo made_of(0, b.motion.get(), b.shape.get());
  made_of.m_friction = static_cast<btScalar>(c.friction);
  b.body = std::make_unique<btRigidBody>(made_of);
  if (c.moves()) {
    b.body->setCollisionFlags(b.body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    b.body->setActivationState(DISABLE_DEACTIVATION);
  }
  world_.addRigidBody(b.body.get());
  bodies_.push_back(std::move(b));
}

void ColliderBodies::add_static(const Collider& c) {
  const btVector3 center = to_bullet(c.center_m);
  btTransform at = btTransform::getIdentity();
  at.setOrigin(center);
  if (c.shape == Collider::Shape::Sphere) {
    add(std::make_unique<btSphereShape>(static_cast<btScalar>(c.radius_m)), at, c);
  } else if (c.shape == Collider::Shape::Box) {
    add(std::make_unique<btBoxShape>(to_bullet(c.half_extent_m)),
        frame(to_bullet(c.axes[0]), to_bullet(c.axes[1]), to_bullet(c.axes[2]), center), c);
  } else {
    const auto half = static_cast<btScalar>(kGroundHalf_m);
    const btVector3 up = to_bullet(c.normal);
    add(std::make_unique<btBoxShape>(btVector3(half, half, half)),
        btTransform(shortestArcQuat(btVector3(0, 1, 0), up), center - up * half), c);
  }
}

void ColliderBodies::add_mesh(const Scene& scene, std::size_t collider) {
  const Collider& c = scene.colliders[collider];
  const std::vector<double> x =
      posed_positions(*c.mesh, scene.motion.empty() ? ColliderPose{} : scene.motion.front().colliders[collider]);
  for (std::size_t t = 0; t < c.mesh->triangles.size(); ++t) {
    const Corners corners = corners_of(*c.mesh, t, x);
    const btTransform at = place(corners);
    const btTransform back = at.inverse();
    auto shape = std::make_unique<btTriangleShape>(back * corners[0], back * corners[1], back * corners[2]);
    shape->setMargin(kTriangleMargin_m);
    if (c.moves()) triangles_.push_back({collider, t, bodies_.size()});
    add(std::move(shape), at, c);
  }
}

void ColliderBodies::add_capsules(const Scene& scene, std::size_t collider) {
  const Collider& c = scene.colliders[collider];
  for (std::size_t k = 0; k < c.capsules.size(); ++k) {
    btQuaternion turn = btQuaternion::getIdentity();
    const btTransform at = place(c.capsules[k], turn);
    capsules_.push_back({collider, k, bodies_.size(), turn});
    add(std::make_unique<btCapsuleShape>(static_cast<btScalar>(c.capsules[k].radius_m),
                                         static_cast<btScalar>(length(c.capsules[k]))),
        at, c);
  }
}

void ColliderBodies::move(const FrameMotion& from, const FrameMotion& to, double share) {
  for (MovingCapsule& m : capsules_) {
    const Capsule c =
        between(from.colliders[m.collider].capsules[m.capsule], to.colliders[m.collider].capsules[m.capsule], share);
    bodies_[m.body].motion->setWorldTransform(place(c, m.turn));
  }
  if (!triangles_.empty()) move_triangles(from, to, share);
}

void ColliderBodies::move_triangles(const FrameMotion& from, const FrameMotion& to, double share) {
  std::vector<double> x;
  std::size_t posed = static_cast<std::size_t>(-1);
  for (const MovingTriangle& m : triangles_) {
    const ColliderMesh& mesh = *colliders_[m.collider].mesh;
    if (posed != m.collider) {
      posed = m.collider;
      x = posed_positions(mesh, from.colliders[posed]);
      const std::vector<double> end = posed_positions(mesh, to.colliders[posed]);
      for (std::size_t k = 0; k < x.size(); ++k) x[k] += share * (end[k] - x[k]);
    }
    bodies_[m.body].motion->setWorldTransform(place(corners_of(mesh, m.triangle, x)));
  }
}

}  // namespace clothbench::bullet_baseline
