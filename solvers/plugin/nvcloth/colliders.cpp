#include "nvcloth/colliders.hpp"

#include <numeric>

namespace clothbench::nvcloth {
namespace {

using peer::Point;

constexpr std::size_t kMost = 32;  // the engine keeps sets of shapes in the bits of a word

std::uint32_t capsule_count(const ClothbenchScene& s) {
  std::uint32_t n = 0;
  for (std::uint32_t k = 0; k < s.collider_count; ++k) n += s.colliders[k].capsule_count;
  return n;
}

/// The plane with this outward normal through a point [m], as the engine's equation n x + d = 0 [cm].
physx::PxVec4 plane(const double* normal, const Point& through, const Point& origin, double margin) {
  const Point p = through - origin;
  const double d = -(normal[0] * p[0] + normal[1] * p[1] + normal[2] * p[2]) - margin;
  return {static_cast<float>(normal[0]), static_cast<float>(normal[1]), static_cast<float>(normal[2]),
          static_cast<float>(d * kPerMetre)};
}

Point end_of(const double* capsule, std::size_t end) { return peer::point(capsule, end); }

/// The sphere of each capsule's end, where ends that coincide share one.
std::vector<std::uint32_t> joined(const std::vector<Point>& ends, std::uint32_t& count) {
  std::vector<std::uint32_t> out;
  std::vector<Point> spheres;
  for (const Point& p : ends) {
    const auto at =
        std::find_if(spheres.begin(), spheres.end(), [&](const Point& q) { return peer::length(p - q) < 1e-6; });
    out.push_back(static_cast<std::uint32_t>(at - spheres.begin()));
    if (at == spheres.end()) spheres.push_back(p);
  }
  count = static_cast<std::uint32_t>(spheres.size());
  return out;
}

std::vector<Point> capsule_ends(const ClothbenchScene& s, const ClothbenchPose* poses) {
  std::vector<Point> out;
  for (std::uint32_t k = 0; k < s.collider_count; ++k)
    for (std::uint32_t c = 0; c < s.colliders[k].capsule_count; ++c)
      for (std::size_t end = 0; end < 2; ++end) out.push_back(end_of(poses[k].capsules + 7 * c, end));
  return out;
}

std::uint32_t count_of(const ClothbenchScene& s, std::int32_t shape) {
  std::uint32_t n = 0;
  for (std::uint32_t k = 0; k < s.collider_count; ++k) n += s.colliders[k].shape == shape;
  return n;
}

}  // namespace

std::string Colliders::obstacle(const ClothbenchScene& s) {
  std::uint32_t ends = 0;
  joined(capsule_ends(s, s.poses), ends);
  if (ends + count_of(s, CLOTHBENCH_SHAPE_SPHERE) > kMost || capsule_count(s) > kMost)
    return "NvCloth collides with at most 32 spheres and ends of capsules";
  if (count_of(s, CLOTHBENCH_SHAPE_PLANE) + 6 * count_of(s, CLOTHBENCH_SHAPE_BOX) > kMost)
    return "NvCloth collides with at most 32 planes and sides of boxes";
  for (std::uint32_t k = 1; k < s.collider_count; ++k)
    if (s.colliders[k].friction != s.colliders[0].friction)
      return "NvCloth has one coefficient of friction for all colliders";
  return "";
}

Colliders::Colliders(const ClothbenchScene& s, const Point& origin, double margin_m)
    : scene_(s), origin_(origin), margin_m_(margin_m) {
  const std::vector<Point> ends = capsule_ends(s, s.poses);
  ends_.resize(ends.size());
  std::iota(ends_.begin(), ends_.end(), 0U);
  capsule_spheres_ = static_cast<std::uint32_t>(ends.size());
  if (ends.size() + count_of(s, CLOTHBENCH_SHAPE_SPHERE) > kMost) ends_ = joined(ends, capsule_spheres_);
  for (std::uint32_t k = 0, planes = 0; k < s.collider_count; ++k) {
    const std::int32_t shape = s.colliders[k].shape;
    const std::uint32_t sides = shape == CLOTHBENCH_SHAPE_PLANE ? 1 : shape == CLOTHBENCH_SHAPE_BOX ? 6 : 0;
    if (sides > 0) convexes_.push_back(((1U << sides) - 1) << planes);
    planes += sides;
    moves_ = moves_ || s.colliders[k].moves != 0;
  }
  put(s.poses);
}

double Colliders::friction() const { return scene_.collider_count > 0 ? scene_.colliders[0].friction : 0; }

Colliders::Shapes Colliders::at(const ClothbenchPose* poses) const {
  Shapes out;
  out.spheres.resize(capsule_spheres_, physx::PxVec4(0.0F));
  std::uint32_t end = 0;
  for (std::uint32_t k = 0; k < scene_.collider_count; ++k) {
    const ClothbenchCollider& c = scene_.colliders[k];
    const double margin = peer::margin(margin_m_, c);
    const Point middle = peer::point(c.center_m, 0);
    if (c.shape == CLOTHBENCH_SHAPE_SPHERE)
      out.spheres.push_back(to_engine(middle, origin_, (c.radius_m + margin) * kPerMetre));
    if (c.shape == CLOTHBENCH_SHAPE_PLANE) out.planes.push_back(plane(c.normal, middle, origin_, margin));
    if (c.shape == CLOTHBENCH_SHAPE_MESH) add_mesh(c, poses[k].vertices_m, out);
    for (std::size_t axis = 0; c.shape == CLOTHBENCH_SHAPE_BOX && axis < 3; ++axis)
      for (const double sign : {1.0, -1.0}) {
        Point through = middle, normal{};
        for (std::size_t i = 0; i < 3; ++i) {
          normal[i] = sign * c.axes[3 * axis + i];
          through[i] += normal[i] * c.half_extent_m[axis];
        }
        out.planes.push_back(plane(normal.data(), through, origin_, margin));
      }
    for (std::uint32_t n = 0; n < 2 * c.capsule_count; ++n, ++end) {
      const double* capsule = poses[k].capsules + 7 * (n / 2);
      physx::PxVec4& sphere = out.spheres[ends_[end]];
      const double radius = std::max(static_cast<double>(sphere.w), (capsule[6] + margin) * kPerMetre);
      sphere = to_engine(end_of(capsule, n % 2), origin_, radius);
    }
  }
  return out;
}

void Colliders::add_mesh(const ClothbenchCollider& c, const double* vertices_m, Shapes& out) const {
  const double margin = peer::margin(margin_m_, c);
  const std::vector<Point> normals = peer::vertex_normals(c, vertices_m);
  for (std::uint32_t k = 0; k < 3 * c.triangle_count; ++k) {
    const std::uint32_t v = c.triangles[k];
    Point p = peer::point(vertices_m, v);
    for (std::size_t i = 0; i < 3; ++i) p[i] += margin * normals[v][i];
    out.triangles.push_back(to_engine(p, origin_, 0).getXYZ());
  }
}

void Colliders::place(nv::cloth::Cloth& cloth) const {
  cloth.setSpheres(range(now_.spheres), 0, 0);
  cloth.setCapsules(range(ends_), 0, 0);
  cloth.setPlanes(range(now_.planes), 0, 0);
  cloth.setConvexes(range(convexes_), 0, 0);
  cloth.setTriangles(range(now_.triangles), 0, 0);
}

void Colliders::move(nv::cloth::Cloth& cloth, const ClothbenchFrame& frame) {
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

}  // namespace clothbench::nvcloth
