#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "clothbench/feature.hpp"
#include "clothbench/vector.hpp"

namespace clothbench {

/// All points within `radius_m` of the segment a-b.
struct Capsule {
  Vec3 a_m{}, b_m{};
  double radius_m = 0;
};

/// An affine map of space as rows of a 3 x 4 matrix: x -> linear part * x + last column [m].
using Affine = std::array<std::array<double, 4>, 3>;

/// Geometry of a mesh collider. It is shared between copies of a scene and never changed.
///
/// A mesh without joints is static, and `positions` are in world coordinates. A mesh with joints follows them by linear
/// blend skinning: x(t) = sum_k weights[k] * M_joints[k](t) * position, with M from ColliderPose::joints (current frame
/// of the joint times the inverse of its frame at rest).
struct ColliderMesh {
  std::vector<double> positions;                        ///< [m], xyz interleaved
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from free space
  bool closed = false;                                  ///< closed surface of a solid, with outward normals
  std::vector<std::array<std::uint8_t, 4>> joints;      ///< per vertex; empty = static
  std::vector<std::array<float, 4>> weights;            ///< per vertex, sum 1
  std::size_t joint_count = 0;

  std::size_t vertex_count() const { return positions.size() / 3; }
  bool skinned() const { return !joints.empty(); }
};

/// A collider: an obstacle that the cloth must not penetrate. One struct serves all shapes; `shape` decides which
/// fields are used. The fields of a moving collider hold its state at t = 0; FrameMotion holds its later states.
struct Collider {
  enum class Shape : std::uint8_t { Plane, Sphere, Box, Capsules, Mesh };
  Shape shape = Shape::Plane;
  std::string name{};    ///< for tables and messages: "living_room/444c8313", "right-hand-sweep"
  double margin_m = 0;   ///< contact offset [m]: distance from the surface at which contact stops the cloth
  double friction = 0;   ///< Coulomb coefficient between cloth and collider
  Vec3 center_m{};       ///< plane: a point on it; sphere, box: centre
  Vec3 normal{};         ///< plane: unit vector into free space
  double radius_m = 0;   ///< sphere
  Vec3 half_extent_m{};  ///< box, along `axes`
  std::array<Vec3, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< box: orthonormal, in world coordinates
  std::vector<Capsule> capsules{};                              ///< their number is constant during a run
  std::shared_ptr<const ColliderMesh> mesh{};
  bool recorded = false;  ///< a user's hand, recorded or live, so its speed is not known in advance

  /// The feature that a solver must support to collide with it.
  Feature feature() const;
  bool moves() const { return !capsules.empty() || (mesh && mesh->skinned()); }
};

/// Pose of one collider at one instant; empty for a static collider.
struct ColliderPose {
  std::vector<Capsule> capsules;
  std::vector<Affine> joints;  ///< a skinned mesh has one matrix per joint
};

/// Poses of all moving colliders and grips at one instant. Between instants, their points move in straight lines.
struct FrameMotion {
  std::vector<ColliderPose> colliders;  ///< one per Scene::colliders
  std::vector<Vec3> grip_position_m;    ///< one per Scene::grips.vertices: its position while held
  std::vector<std::uint8_t> grip_held;  ///< one per Scene::grips.vertices: 1 while held, 0 once released
};

/// Vertex positions [m], xyz interleaved, of a mesh in a pose: skinned, or as stored for a static mesh.
std::vector<double> posed_positions(const ColliderMesh&, const ColliderPose&);

}  // namespace clothbench
