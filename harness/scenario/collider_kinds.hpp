#pragma once
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

class ColliderReader;

/// A `type` of collider in scene files. Its keys are definitions/collider_<name> of the schema.
struct ColliderType {
  const char* name;
  /// Fills in the collider from valid JSON with all defaults. Motion and table, if any, are stored in the reader.
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

/// The region to show. An infinite surface is shown as a square with sides of 2 `reach_m`, centred at its point nearest
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

/// Description of one shape of collider, made by a function in collider_kinds.cpp. Loading, metrics, rendering,
/// replays, the page and features use it; no other code of the harness distinguishes shapes. Solvers handle each shape
/// in their own code.
struct ColliderKind {
  Collider::Shape shape = Collider::Shape::Plane;
  const char* name = "";                                       ///< name in result files
  Feature standing = Feature::Plane, moving = Feature::Plane;  ///< required if the collider is static; if it moves
  std::vector<ColliderType> types = {};
  /// The form in result files: numbers, and the capsules or the mesh of every frame.
  std::vector<ColliderNumbers> numbers = {};
  enum class Holds { Numbers, Capsules, Mesh } holds = Holds::Numbers;

  // The geometry is a union of capsules or a surface of triangles; the function for the other form is nullptr.
  std::vector<Capsule> (*capsules)(const Collider&, const ColliderPose&) = nullptr;
  ColliderSurface (*surface)(const Collider&, const ColliderPose&, const Extent&) = nullptr;
  /// Exact nearest point on a static collider, used instead of its triangles.
  SurfacePlace (*nearest)(const Collider&, const Vec3&) = nullptr;
  bool half_space = false;  ///< solid on the side of `center_m` opposite to `normal`
  bool convex = false;      ///< lies on one side of the plane of each of its triangles
};

/// One per shape, in the order of Collider::Shape.
const std::vector<ColliderKind>& collider_kinds();
/// The kind of this collider. Throws Error if there is none.
const ColliderKind& kind_of(const Collider&);

}  // namespace clothbench
