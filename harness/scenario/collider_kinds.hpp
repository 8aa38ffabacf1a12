#pragma once
#include <nlohmann/json.hpp>
#include <span>
#include <utility>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

class ColliderReader;

/// A way to write a collider of some kind in a scene. Its keys are definitions/collider_<name> of the schema.
struct ColliderType {
  const char* name;
  /// Fills in the collider from valid JSON with all its defaults; what else there is to say goes to the reader.
  void (*read)(const nlohmann::json&, ColliderReader&, Collider&);
};

/// Numbers of a collider that result files keep as an attribute: one, or a vector.
struct ColliderNumbers {
  const char* name;
  std::size_t count;
  double* (*at)(Collider&);
};

/// Where a surface is nearest to a point.
struct SurfacePlace {
  double distance_m;  ///< negative inside
  Vec3 normal;        ///< unit, outwards
};

/// What is to be seen: a surface without an end is shown as a square of twice `reach_m` round the point of it that is
/// nearest to `middle`.
struct Extent {
  Vec3 middle{};
  double reach_m = 2;
};

/// Triangles of a surface at one instant, counter-clockwise seen from free space.
struct ColliderSurface {
  std::vector<double> positions;                            ///< [m], xyz interleaved
  std::span<const std::array<std::uint32_t, 3>> triangles;  ///< the collider's own, or there until the program ends
};

/// All that the harness knows of one shape of collider: a file in kinds/, found there by CMake. Loading, metrics,
/// pictures, replays, the page and features ask here; nothing else tells shapes apart. Solvers answer to a shape in
/// their own way.
struct ColliderKind {
  Collider::Shape shape = Collider::Shape::Plane;
  const char* name = "";                                       ///< in result files
  Feature standing = Feature::Plane, moving = Feature::Plane;  ///< what a solver needs for one
  std::vector<ColliderType> types = {};
  /// One of each feature so far away that it cannot matter; see irrelevant.hpp.
  std::vector<std::pair<Feature, nlohmann::json>> far = {};
  /// What result files keep: numbers, and the capsules or the mesh of every frame.
  std::vector<ColliderNumbers> numbers = {};
  enum class Holds { Numbers, Capsules, Mesh } holds = Holds::Numbers;

  // Its geometry is a union of capsules or a surface of triangles.
  std::vector<Capsule> (*capsules)(const Collider&, const ColliderPose&) = nullptr;
  ColliderSurface (*surface)(const Collider&, const ColliderPose&, const Extent&) = nullptr;
  /// The exact distance of something that stands still, where its triangles are not to be asked.
  SurfacePlace (*nearest)(const Collider&, const Vec3&) = nullptr;
  bool half_space = false;  ///< all behind `center_m`, against `normal`
  bool convex = false;      ///< every triangle's plane has all of it on one side
};

/// One of each shape, in the order of Collider::Shape.
const std::vector<ColliderKind>& collider_kinds();
/// Throws Error if there is none.
const ColliderKind& kind_of(const Collider&);

inline constexpr double kFar_m = 100;  ///< how far away a `far` collider is

}  // namespace clothbench
