/// Coordinates and colliders in NvCloth's form.
#pragma once

#include <NvCloth/Cloth.h>

#include "peer.hpp"

namespace clothbench::nvcloth {

using peer::kSupports, peer::Point, physx::PxVec3, physx::PxVec4;

/// Lengths are in centimetres here, because the engine's epsilons are absolute (1.2e-7 on squared lengths): in metres
/// the cloth stretches two to three times more.
constexpr double kPerMetre = 100;
constexpr std::size_t kMaxShapes = 32;  // the engine stores sets of shapes as bits of a 32-bit word

/// Converts a point from [m] to the engine's [cm]; w: radius [cm], inverse mass or unused.
inline PxVec4 to_engine(const Point& x, double w) {
  const auto to = [&](std::size_t k) { return static_cast<float>(x[k] * kPerMetre); };
  return {to(0), to(1), to(2), static_cast<float>(w)};
}

template <typename T>
nv::cloth::Range<const T> range(const std::vector<T>& v) {
  return {v.data(), v.data() + v.size()};
}

/// The scene's colliders, inflated by their margins. Planes and boxes become convexes, so inflated boxes have sharp
/// corners; vertices of meshes are moved along their normals.
class Colliders {
 public:
  /// `margin_m` replaces the colliders' margins, unless it is 0.
  Colliders(const ClothbenchScene& s, const Point& origin, double margin_m)
      : scene_(s), origin_(origin), margin_m_(margin_m) {
    std::vector<Point> spheres;
    std::uint32_t planes = 0;
    for (std::uint32_t k = 0; k < s.collider_count; ++k) {
      // Coincident ends of capsules share a sphere.
      for (std::uint32_t n = 0; n < 2 * s.colliders[k].capsule_count; ++n) {
        const Point end = capsule_end(s.poses[k], n);
        const auto same = [&](const Point& other) { return peer::length(end - other) < 1e-6; };
        const auto at = std::find_if(spheres.begin(), spheres.end(), same);
        ends_.push_back(static_cast<std::uint32_t>(at - spheres.begin()));
        if (at == spheres.end()) spheres.push_back(end);
      }
      const std::int32_t shape = s.colliders[k].shape;
      const std::uint32_t sides = shape == CLOTHBENCH_SHAPE_PLANE ? 1 : shape == CLOTHBENCH_SHAPE_BOX ? 6 : 0;
      if (sides > 0 && planes + sides <= kMaxShapes) convexes_.push_back(((1U << sides) - 1) << planes);
      planes += sides;
      moves_ = moves_ || s.colliders[k].moves != 0;
    }
    capsule_spheres_ = spheres.size();
    put(s.poses);
  }

  std::string obstacle() const {
    if (now_.spheres.size() > kMaxShapes || ends_.size() > 2 * kMaxShapes)
      return "NvCloth collides with at most 32 spheres and ends of capsules";
    if (now_.planes.size() > kMaxShapes) return "NvCloth collides with at most 32 planes and sides of boxes";
    for (std::uint32_t k = 1; k < scene_.collider_count; ++k)
      if (scene_.colliders[k].friction != scene_.colliders[0].friction)
        return "NvCloth has one coefficient of friction for all colliders";
    return "";
  }

  bool has_spheres() const { return !now_.spheres.empty(); }
  void put(const ClothbenchPose* poses) { now_ = at(poses); }

  /// Adds the colliders to a new cloth, in their poses at the start of the next frame.
  void place(nv::cloth::Cloth& cloth) const {
    cloth.setSpheres(range(now_.spheres), 0, 0);
    cloth.setCapsules(range(ends_), 0, 0);
    cloth.setPlanes(range(now_.planes), 0, 0);
    cloth.setConvexes(range(convexes_), 0, 0);
    cloth.setTriangles(range(now_.triangles), 0, 0);
  }

  /// Moves colliders from their current poses to the frame's; a collider that teleports starts in its new pose.
  void move(nv::cloth::Cloth& cloth, const ClothbenchFrame& frame) {
    if (!moves_) return;
    Shapes start = std::move(now_);
    now_ = at(frame.poses);
    if (frame.collider_teleports != nullptr) {
      std::vector<ClothbenchPose> from(frame.poses_before, frame.poses_before + scene_.collider_count);
      for (std::uint32_t k = 0; k < scene_.collider_count; ++k)
        if (frame.collider_teleports[k] != 0) from[k] = frame.poses[k];
      start = at(from.data());
    }
    if (!now_.spheres.empty()) cloth.setSpheres(range(start.spheres), range(now_.spheres));
    if (!now_.triangles.empty()) cloth.setTriangles(range(start.triangles), range(now_.triangles), 0);
  }

 private:
  struct Shapes {
    std::vector<PxVec4> spheres, planes;
    std::vector<PxVec3> triangles;
    /// Adds the plane with outward normal `n` at `margin` [m] above a point, in the engine's form n x + d = 0.
    void add_plane(const Point& n, const Point& through, double margin) {
      const double d = -peer::dot(n, through) - margin;
      planes.push_back({static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2]),
                        static_cast<float>(d * kPerMetre)});
    }
  };

  static Point capsule_end(const ClothbenchPose& pose, std::uint32_t n) {
    return peer::point(pose.capsules + 7 * (n / 2), n % 2);
  }

  Shapes at(const ClothbenchPose* poses) const {
    Shapes out;
    out.spheres.resize(capsule_spheres_, PxVec4(0.0F));
    auto sphere_of_end = ends_.begin();
    for (std::uint32_t k = 0; k < scene_.collider_count; ++k) {
      const ClothbenchCollider& c = scene_.colliders[k];
      const double margin = peer::margin(margin_m_, c);
      const Point middle = peer::point(c.center_m, 0) - origin_;
      if (c.shape == CLOTHBENCH_SHAPE_SPHERE)
        out.spheres.push_back(to_engine(middle, (c.radius_m + margin) * kPerMetre));
      if (c.shape == CLOTHBENCH_SHAPE_PLANE) out.add_plane(peer::point(c.normal, 0), middle, margin);
      for (std::size_t axis = 0; c.shape == CLOTHBENCH_SHAPE_BOX && axis < 3; ++axis)
        for (const double sign : {1.0, -1.0}) {
          const Point normal = sign * peer::point(c.axes, axis);
          out.add_plane(normal, middle + c.half_extent_m[axis] * normal, margin);
        }
      if (c.shape == CLOTHBENCH_SHAPE_MESH) {
        const std::vector<Point> normals = peer::vertex_normals(c, poses[k].vertices_m);
        for (std::uint32_t n = 0; n < 3 * c.triangle_count; ++n) {
          const std::uint32_t v = c.triangles[n];
          const Point moved = peer::point(poses[k].vertices_m, v) + margin * normals[v];
          out.triangles.push_back(to_engine(moved - origin_, 0).getXYZ());
        }
      }
      for (std::uint32_t n = 0; n < 2 * c.capsule_count; ++n) {
        PxVec4& sphere = out.spheres[*sphere_of_end++];
        const double radius_m = poses[k].capsules[7 * (n / 2) + 6] + margin;
        const double radius = std::max(static_cast<double>(sphere.w), radius_m * kPerMetre);
        sphere = to_engine(capsule_end(poses[k], n) - origin_, radius);
      }
    }
    return out;
  }

  const ClothbenchScene& scene_;
  Point origin_;
  double margin_m_;
  std::vector<std::uint32_t> ends_;      ///< index of the sphere of each end of all capsules
  std::vector<std::uint32_t> convexes_;  ///< sets of planes, as bits
  std::size_t capsule_spheres_ = 0;
  Shapes now_;  ///< at the end of the last frame
  bool moves_ = false;
};

}  // namespace clothbench::nvcloth
