#pragma once
#include <cmath>
#include <memory>

#include "gpu_fixture.hpp"

namespace clothbench::pbd_gpu {

inline constexpr double kContactFriction = 0.3, kMargin_m = 0.02;

inline Collider touching(Collider::Shape shape, double friction) {
  return {.shape = shape, .margin_m = kMargin_m, .friction = friction};
}

inline Scene with_collider(Scene s, const Collider& c) {
  s.colliders.push_back(c);
  s.needs.add(c.feature());
  if (c.friction > 0) s.needs.add(Feature::Friction);
  return s;
}

/// The scene with two-sided contact, as `xpbd` supports it.
inline Scene two_sided(Scene s) {
  s.cloth.sides = Sides::Double;
  s.needs = s.needs - FeatureSet{Feature::DuplicatedLayer};
  s.needs.add(Feature::DoubleSided);
  return s;
}

inline Scene doubled(Scene s) {
  s.cloth.sides = Sides::DoubleDuplicated;
  s.needs.add(Feature::DuplicatedLayer);
  return s;
}

inline Collider sphere(Vec3 center, double radius, double friction = 0) {
  using enum Collider::Shape;
  return {.shape = Sphere, .margin_m = kMargin_m, .friction = friction, .center_m = center, .radius_m = radius};
}

inline Collider half_space(Vec3 point, Vec3 normal, double friction) {
  using enum Collider::Shape;
  return {.shape = Plane, .margin_m = kMargin_m, .friction = friction, .center_m = point, .normal = normal};
}

/// A box that is rotated about two axes, so that no face is horizontal.
inline Collider box(Vec3 center, Vec3 half, double friction = 0) {
  Collider c = touching(Collider::Shape::Box, friction);
  c.center_m = center;
  c.half_extent_m = half;
  const double a = 0.4, b = 0.3;
  c.axes = {{{std::cos(a), std::sin(a), 0},
             {-std::sin(a) * std::cos(b), std::cos(a) * std::cos(b), std::sin(b)},
             {std::sin(a) * std::sin(b), -std::cos(a) * std::sin(b), std::cos(b)}}};
  return c;
}

/// Two capsules, one of them a sphere; `moving` moves them.
inline Collider capsules(Vec3 at, double friction = 0) {
  Collider c = touching(Collider::Shape::Capsules, friction);
  c.capsules = {{{at[0] - 0.2, at[1] + 0.013, at[2]}, {at[0] + 0.21, at[1] - 0.02, at[2] + 0.11}, 0.05},
                {{at[0], at[1], at[2] + 0.3}, {at[0], at[1], at[2] + 0.3}, 0.07}};
  return c;
}

/// Octahedron with outward normals, twice as long along x. With joints, each half follows one joint and the ring
/// between them follows both.
inline Collider octahedron(Vec3 at, double radius, bool skinned, double friction = 0) {
  Collider c = touching(Collider::Shape::Mesh, friction);
  auto mesh = std::make_shared<ColliderMesh>();
  for (int k = 0; k < 6; ++k) {
    Vec3 p = at;
    p[static_cast<std::size_t>(k / 2)] += (k % 2 == 0 ? 1 : -1) * radius * (k < 2 ? 2 : 1);
    mesh->positions.insert(mesh->positions.end(), p.begin(), p.end());
  }
  for (std::uint32_t x : {0u, 1u})
    for (std::uint32_t y : {2u, 3u})
      for (std::uint32_t z : {4u, 5u}) {
        const bool even = (x + y + z) % 2 == 0;
        mesh->triangles.push_back({x, even ? y : z, even ? z : y});
      }
  mesh->closed = true;
  if (skinned) {
    mesh->joint_count = 2;
    for (int k = 0; k < 6; ++k) {
      mesh->joints.push_back({0, 1, 0, 0});
      mesh->weights.push_back(k == 0   ? std::array<float, 4>{1, 0, 0, 0}
                              : k == 1 ? std::array<float, 4>{0, 1, 0, 0}
                                       : std::array<float, 4>{0.25f, 0.75f, 0, 0});
    }
  }
  c.mesh = mesh;
  return c;
}

/// Open sheet of two triangles under the cloth, facing up.
inline Collider open_sheet(Vec3 at, double half, double friction = 0) {
  Collider c = touching(Collider::Shape::Mesh, friction);
  auto mesh = std::make_shared<ColliderMesh>();
  mesh->positions = {at[0] - half, at[1], at[2] - half, at[0] + half, at[1] + 0.01, at[2] - half,
                     at[0] + half, at[1], at[2] + half, at[0] - half, at[1] - 0.01, at[2] + half};
  mesh->triangles = {{0, 3, 2}, {0, 2, 1}};
  c.mesh = mesh;
  return c;
}

/// Pose of a moving collider at instant k: it moves by 0.01 m along x per instant and rotates a little, joint by joint.
inline ColliderPose pose_at(const Collider& c, int k) {
  ColliderPose pose;
  const double way = 0.01 * k;
  for (Capsule moved : c.capsules) {
    moved.a_m[0] += way;
    moved.b_m[0] += way;
    moved.b_m[1] += 0.5 * way;
    pose.capsules.push_back(moved);
  }
  for (std::size_t joint = 0; c.mesh && joint < c.mesh->joint_count; ++joint) {
    const double turn = 0.05 * k * (joint == 0 ? 1 : -1), cosine = std::cos(turn), sine = std::sin(turn);
    pose.joints.push_back({{{cosine, -sine, 0, way}, {sine, cosine, 0, 0.5 * way}, {0, 0, 1, 0}}});
  }
  return pose;
}

/// The sheet folded over a line along v, with its layers `apart` m apart, and with self-contact.
inline Scene folded(Scene s, double apart = 0.1, double friction = 0) {
  Cloth& c = s.cloth;
  c.axis_u = {0, 1, 0};
  c.axis_v = {0, 0, 1};
  c.drape_radius_m = std::max(apart / 2, 0.51 * c.du());
  c.self_collision = {0.5 * c.least_height_m(), friction};
  s.needs.add(Feature::SelfCollision);
  if (friction > 0) s.needs.add(Feature::Friction);
  return s;
}

/// The scene with motion of all kinematic colliders and of `grips`, which move by (0.02, 0.03, -0.01) m per frame and
/// release their vertices at instant `release`.
inline Scene moving(Scene s, std::vector<std::uint32_t> grips = {}, int release = 1000) {
  const std::vector<double> x = initial_positions(s);
  s.grips.vertices = std::move(grips);
  if (!s.grips.vertices.empty()) s.needs.add(Feature::MovingPins);
  for (int k = 0; k <= s.time.frames(); ++k) {
    FrameMotion& m = s.motion.emplace_back();
    for (const Collider& c : s.colliders) m.colliders.push_back(pose_at(c, k));
    for (std::uint32_t v : s.grips.vertices) {
      m.grip_position_m.push_back({x[3 * v] + 0.02 * k, x[3 * v + 1] + 0.03 * k, x[3 * v + 2] - 0.01 * k});
      m.grip_held.push_back(k < release ? 1 : 0);
    }
  }
  return s;
}

/// One collider of every kind that `paper` supports, within reach of a sheet of 1 x 1 m at the origin.
inline Scene everything(Scene s, double friction = kContactFriction) {
  s = doubled(s);
  s = with_collider(s, sphere({-0.31, -0.05, -0.27}, 0.17, friction));
  s = with_collider(s, sphere({-0.1, 0.08, -0.33}, 0.11, friction));
  s = with_collider(s, box({0.31, -0.03, -0.29}, {0.14, 0.09, 0.11}, friction));
  s = with_collider(s, open_sheet({0.33, -0.006, 0.31}, 0.123, friction));
  s = with_collider(s, octahedron({0.013, 0.007, 0.021}, 0.06, false, friction));
  s = with_collider(s, octahedron({-0.023, 0.009, 0.34}, 0.071, true, friction));
  s = with_collider(s, octahedron({-0.024, 0.011, -0.12}, 0.041, true, friction));
  s = with_collider(s, capsules({-0.28, 0.017, 0.05}, friction));
  return moving(s);
}

}  // namespace clothbench::pbd_gpu
