#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "clothbench/feature.hpp"

namespace clothbench {

using Vec3 = std::array<double, 3>;

/// All points within `radius_m` of the segment a-b.
struct Capsule {
  Vec3 a_m{}, b_m{};
  double radius_m = 0;
};

/// An affine map of space, rows of a 3 x 4 matrix: x -> linear part * x + last column [m].
using Affine = std::array<std::array<double, 4>, 3>;

/// Geometry of a mesh collider. Shared between copies of a scene, never changed.
///
/// A mesh without joints stands still and `positions` are in the world. One with joints follows them by linear blend
/// skinning: x(t) = sum_k weights[k] * M_joints[k](t) * position, with M from FrameMotion::joints (frame of the joint
/// now times the inverse of its frame at rest).
struct ColliderMesh {
  std::vector<double> positions;                        ///< [m], xyz interleaved
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from free space
  bool closed = false;                                  ///< has an inside, on the far side of its normals
  std::vector<std::array<std::uint8_t, 4>> joints;      ///< per vertex; empty = stands still
  std::vector<std::array<float, 4>> weights;            ///< per vertex, sum 1
  std::size_t joint_count = 0;

  std::size_t vertex_count() const { return positions.size() / 3; }
  bool skinned() const { return !joints.empty(); }
};

/// Something cloth must not pass. One struct for all shapes; `shape` says which fields count. What moves is as at
/// t = 0 here, and in FrameMotion afterwards.
struct Collider {
  enum class Shape : std::uint8_t { Plane, Sphere, Box, Capsules, Mesh };
  Shape shape = Shape::Plane;
  std::string name;      ///< for tables and messages: "living_room/444c8313", "right-hand-sweep"
  double margin_m = 0;   ///< distance from the surface at which contact holds the cloth
  double friction = 0;   ///< Coulomb coefficient of the pair
  Vec3 center_m{};       ///< plane: a point on it; sphere, box: centre
  Vec3 normal{};         ///< plane: unit, into free space
  double radius_m = 0;   ///< sphere
  Vec3 half_extent_m{};  ///< box, along `axes`
  std::array<Vec3, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< box: orthonormal, in the world
  std::vector<Capsule> capsules;                                ///< their number never changes
  std::shared_ptr<const ColliderMesh> mesh;

  /// What a solver needs for it.
  Feature feature() const;
  bool moves() const { return !capsules.empty() || (mesh && mesh->skinned()); }
};

/// Where one collider is at one instant; empty for a static collider.
struct ColliderPose {
  std::vector<Capsule> capsules;
  std::vector<Affine> joints;  ///< of a skinned mesh, joint_count of them
};

/// Where everything that moves is at one instant. Between two of them capsule ends, skinned vertices and gripped
/// vertices move in straight lines.
struct FrameMotion {
  std::vector<ColliderPose> colliders;  ///< one per Scene::colliders
  std::vector<Vec3> grip_position_m;    ///< one per Scene::grips.vertices, where it is while held
  std::vector<std::uint8_t> grip_held;  ///< the same: 1 from this instant on while held, 0 once let go
};

/// Positions [m], xyz interleaved, of a mesh's vertices under a pose: skinned, or as stored where it stands still.
std::vector<double> posed_positions(const ColliderMesh&, const ColliderPose&);

}  // namespace clothbench
