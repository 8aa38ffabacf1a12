/// A scene's colliders as NvCloth's: spheres and capsules, convexes of planes, triangles.
#pragma once

#include "nvcloth/engine.hpp"

namespace clothbench::nvcloth {

/// Shapes are inflated by their margins. Planes and boxes are convexes, whose corners stay sharp; vertices of triangles
/// move along their normals.
class Colliders {
 public:
  /// `margin_m`: in place of the colliders' margins; 0: theirs.
  Colliders(const ClothbenchScene&, const peer::Point& origin, double margin_m);

  /// Why the engine cannot hold the cloth off this scene's colliders; empty if it can.
  static std::string obstacle(const ClothbenchScene&);

  bool has_spheres() const { return !now_.spheres.empty(); }
  double friction() const;
  /// Gives a new cloth the colliders as they are at the start of the next frame.
  void place(nv::cloth::Cloth&) const;
  /// Lets moving colliders go from where they are to the frame's poses; one that teleports is there at once.
  void move(nv::cloth::Cloth&, const ClothbenchFrame&);
  void put(const ClothbenchPose* poses) { now_ = at(poses); }

 private:
  struct Shapes {
    std::vector<physx::PxVec4> spheres, planes;
    std::vector<physx::PxVec3> triangles;
  };
  Shapes at(const ClothbenchPose*) const;
  void add_mesh(const ClothbenchCollider&, const double* vertices_m, Shapes&) const;

  const ClothbenchScene& scene_;
  peer::Point origin_;
  double margin_m_;
  std::vector<std::uint32_t>
      ends_;  ///< the sphere of each capsule's end, over all capsules; capsules are pairs of them
  std::uint32_t capsule_spheres_ = 0;
  std::vector<std::uint32_t> convexes_;  ///< sets of planes
  Shapes now_;                           ///< where the last frame left them
  bool moves_ = false;
};

}  // namespace clothbench::nvcloth
