/// Coordinates and colliders in NvCloth's form.
#pragma once

#include <NvCloth/Cloth.h>

#include "peer.hpp"

namespace clothbench::nvcloth {

using peer::Point, physx::PxVec3, physx::PxVec4;

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

/// The scene's colliders in one pose, inflated by their margins, in the coordinates of one sheet. Planes and boxes
/// become convexes, so inflated boxes have sharp corners; vertices of meshes are moved along their normals.
struct Shapes {
  std::vector<PxVec4> spheres, planes;
  std::vector<PxVec3> triangles;
  std::vector<std::uint32_t> capsules, convexes;  ///< indices of two spheres each; sets of planes, as bits
};

inline Point capsule_end(const ClothbenchPose& pose, std::size_t n) {
  return peer::point(pose.capsules + 7 * (n / 2), n % 2);
}

/// Index of a sphere for each end of all capsules. Coincident ends share a sphere.
inline std::vector<std::uint32_t> capsules_of(const ClothbenchScene& s) {
  std::vector<Point> spheres;
  std::vector<std::uint32_t> out;
  for (std::uint32_t k = 0; k < s.collider_count; ++k)
    for (std::uint32_t n = 0; n < 2 * s.colliders[k].capsule_count; ++n) {
      const Point end = capsule_end(s.poses[k], n);
      const auto same = [&](const Point& other) { return peer::length(end - other) < 1e-6; };
      const auto at = std::find_if(spheres.begin(), spheres.end(), same);
      out.push_back(static_cast<std::uint32_t>(at - spheres.begin()));
      if (at == spheres.end()) spheres.push_back(end);
    }
  return out;
}

/// `margin_m` replaces the colliders' margins, unless it is 0.
inline Shapes shapes_of(const ClothbenchScene& s, const ClothbenchPose* poses, const Point& origin, double margin_m) {
  Shapes out;
  out.capsules = capsules_of(s);
  for (const std::uint32_t sphere : out.capsules)
    if (sphere == out.spheres.size()) out.spheres.emplace_back(0.0F);
  auto sphere_of_end = out.capsules.begin();
  for (std::uint32_t k = 0; k < s.collider_count; ++k) {
    const ClothbenchCollider& c = s.colliders[k];
    const double margin = peer::margin(margin_m, c);
    const Point middle = peer::point(c.center_m, 0) - origin;
    const std::size_t first_plane = out.planes.size();
    const auto add_plane = [&](const Point& n, const Point& through) {  // n x + d = 0 with the outward normal n
      const double d = -peer::dot(n, through) - margin;
      out.planes.push_back({static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2]),
                            static_cast<float>(d * kPerMetre)});
    };
    if (c.shape == CLOTHBENCH_SHAPE_SPHERE) out.spheres.push_back(to_engine(middle, (c.radius_m + margin) * kPerMetre));
    if (c.shape == CLOTHBENCH_SHAPE_PLANE) add_plane(peer::point(c.normal, 0), middle);
    for (std::size_t axis = 0; c.shape == CLOTHBENCH_SHAPE_BOX && axis < 3; ++axis)
      for (const double sign : {1.0, -1.0}) {
        const Point normal = sign * peer::point(c.axes, axis);
        add_plane(normal, middle + c.half_extent_m[axis] * normal);
      }
    if (out.planes.size() > first_plane && out.planes.size() <= kMaxShapes)
      out.convexes.push_back(static_cast<std::uint32_t>((1ULL << out.planes.size()) - (1ULL << first_plane)));
    if (c.shape == CLOTHBENCH_SHAPE_MESH) {
      const std::vector<Point> normals = peer::vertex_normals(c, poses[k].vertices_m);
      for (std::uint32_t n = 0; n < 3 * c.triangle_count; ++n) {
        const std::uint32_t v = c.triangles[n];
        const Point moved = peer::point(poses[k].vertices_m, v) + margin * normals[v];
        out.triangles.push_back(to_engine(moved - origin, 0).getXYZ());
      }
    }
    for (std::uint32_t n = 0; n < 2 * c.capsule_count; ++n) {
      PxVec4& sphere = out.spheres[*sphere_of_end++];
      const double radius_m = poses[k].capsules[7 * (n / 2) + 6] + margin;
      const double radius = std::max(static_cast<double>(sphere.w), radius_m * kPerMetre);
      sphere = to_engine(capsule_end(poses[k], n) - origin, radius);
    }
  }
  return out;
}

}  // namespace clothbench::nvcloth
