#pragma once
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

class ColliderReader;

/// A `type` of collider in a scene file. Its keys are definitions/collider_<name> of the schema.
struct ColliderType {
  const char* name;
  /// Fills in the collider from valid JSON with all defaults. Its motion and its table, if any, go to the reader.
  void (*read)(const nlohmann::json&, ColliderReader&, Collider&);
};

/// A number or vector of a collider that result files store as an attribute.
struct ColliderNumbers {
  const char* name;
  std::size_t count;
  double* (*at)(Collider&);
};

/// The nearest point of a surface to a query point.
struct SurfacePlace {
  double distance_m;  ///< negative inside
  Vec3 normal;        ///< unit vector, outwards
};

/// The visible region. An infinite surface is shown as a square with sides of 2 `reach_m`, centred at its nearest point
/// to `middle`.
struct Extent {
  Vec3 middle{};
  double reach_m = 2;
};

/// Triangles of a surface at one instant, counter-clockwise seen from free space.
struct ColliderSurface {
  std::vector<double> positions;                            ///< [m], xyz interleaved
  std::span<const std::array<std::uint32_t, 3>> triangles;  ///< owned by the collider, or static data
};

/// Description of one shape of collider: a function in collider_kinds.cpp. Loading, metrics, pictures, replays,
/// the page and features all use it; no other code of the harness distinguishes shapes. Solvers handle each shape in
/// their own code.
struct ColliderKind {
  Collider::Shape shape = Collider::Shape::Plane;
  const char* name = "";                                       ///< name in result files
  Feature standing = Feature::Plane, moving = Feature::Plane;  ///< required of a solver for a static and a dynamic one
  std::vector<ColliderType> types = {};
  /// The form that result files store: numbers, and the capsules or the mesh of every frame.
  std::vector<ColliderNumbers> numbers = {};
  enum class Holds { Numbers, Capsules, Mesh } holds = Holds::Numbers;

  // The geometry is a union of capsules or a triangulated surface.
  std::vector<Capsule> (*capsules)(const Collider&, const ColliderPose&) = nullptr;
  ColliderSurface (*surface)(const Collider&, const ColliderPose&, const Extent&) = nullptr;
  /// The exact distance to a static collider, used instead of the distance to its triangles.
  SurfacePlace (*nearest)(const Collider&, const Vec3&) = nullptr;
  bool half_space = false;  ///< solid on the side of `center_m` opposite to `normal`
  bool convex = false;      ///< lies on one side of the plane of every triangle
};

/// One of each shape, in the order of Collider::Shape.
const std::vector<ColliderKind>& collider_kinds();
/// The kind of this collider. Throws Error if there is none.
const ColliderKind& kind_of(const Collider&);

}  // namespace clothbench
