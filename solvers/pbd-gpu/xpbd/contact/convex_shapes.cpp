#include <algorithm>
#include <numeric>

#include "xpbd/contact/contact.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Minimum margin as a fraction of the smaller cell size: 0.16 mm for a cloth of 0.5 m with 32 vertices per side.
constexpr double kMinMargin = 0.01;

void split(const std::vector<Vec3>& centroids, std::vector<std::uint32_t>::iterator first,
           std::vector<std::uint32_t>::iterator last, std::vector<std::uint32_t>& sizes) {
  const auto count = static_cast<std::size_t>(last - first);
  if (count <= Clusters::kClusterSize) {
    if (count > 0) sizes.push_back(static_cast<std::uint32_t>(count));
    return;
  }
  Vec3 low = centroids[*first], high = low;
  for (auto t = first; t != last; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], centroids[*t][k]);
      high[k] = std::max(high[k], centroids[*t][k]);
    }
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
  // Ties are broken by index, so that clusters are the same on every machine.
  const auto middle = first + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(first, middle, last, [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(centroids[a][axis], a) < std::pair(centroids[b][axis], b);
  });
  std::sort(first, middle);
  std::sort(middle, last);
  split(centroids, first, middle, sizes);
  split(centroids, middle, last, sizes);
}

class Maker {
 public:
  Maker(const Scene& scene, Vec3 origin, const ColliderBuffers* colliders)
      : scene_(scene), origin_(origin), colliders_(colliders) {}

  ConvexShapes all() {
    const double smallest = kMinMargin * std::min(scene_.cloth.du(), scene_.cloth.dv());
    for (std::size_t k = 0; k < scene_.colliders.size(); ++k) {
      const Collider& c = scene_.colliders[k];
      made_.margins_m.push_back(std::max(c.margin_m, smallest));
      made_.max_margin_m = std::max(made_.max_margin_m, made_.margins_m.back());
      add(c, k);
    }
    add_boxes();
    return std::move(made_);
  }

 private:
  void add(const Collider& c, std::size_t k) {
    if (c.shape == Collider::Shape::Sphere) {
      begin(k, c.radius_m);
      point(c.center_m);
    } else if (c.shape == Collider::Shape::Box) {
      add_box(c, k);
    } else if (c.shape == Collider::Shape::Capsules) {
      for (const Capsule& s : c.capsules) {
        begin(k, s.radius_m);
        from_capsule(s.a_m);
        from_capsule(s.b_m);
      }
    } else if (c.shape == Collider::Shape::Mesh) {
      add_mesh(c, k);
    }
  }

  /// Adds the faces as triangles, because a face's plane separates most cloth triangles on it (separated_by_face).
  void add_box(const Collider& c, std::size_t k) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      const unsigned a = 1u << axis, b = 1u << (axis + 1) % 3, side = 1u << (axis + 2) % 3;
      for (const unsigned from : {0u, side}) {
        for (const unsigned third : {a, b}) {
          begin(k, 0);
          for (const unsigned corner : {from, from + third, from + a + b}) point(corner_of(c, corner));
        }
      }
    }
  }

  static Vec3 corner_of(const Collider& c, unsigned corner) {
    Vec3 at = c.center_m;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t d = 0; d < 3; ++d)
        at[d] += ((corner >> axis & 1) != 0 ? 1 : -1) * c.half_extent_m[axis] * c.axes[axis][d];
    return at;
  }

  void add_mesh(const Collider& c, std::size_t k) {
    const ColliderMesh& mesh = *c.mesh;
    const std::vector<double> at =
        c.moves() ? posed_positions(mesh, scene_.motion.at(0).colliders.at(k)) : mesh.positions;
    const auto vertex = [&](std::uint32_t v) { point({at[3 * v], at[3 * v + 1], at[3 * v + 2]}); };
    const Clusters clusters = cluster(at, mesh.triangles);
    if (!c.moves()) {
      for (const std::uint32_t t : clusters.triangles) {
        begin(k, 0);
        for (const std::uint32_t v : mesh.triangles[t]) vertex(v);
      }
      return;
    }
    const auto range =
        std::find_if(colliders_->kinematic_meshes.ranges.begin(), colliders_->kinematic_meshes.ranges.end(),
                     [&](const MeshRange& r) { return r.collider == k; });
    std::size_t next = 0;
    for (const std::uint32_t size : clusters.sizes) {
      std::vector<std::uint32_t> corners;
      for (const std::size_t end = next + size; next < end; ++next)
        for (const std::uint32_t v : mesh.triangles[clusters.triangles[next]]) corners.push_back(v);
      std::sort(corners.begin(), corners.end());
      corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
      begin(k, 0);
      for (const std::uint32_t v : corners) {
        made_.sources.push_back({static_cast<uint>(made_.points.size()), range->first_vertex + v, 0});
        vertex(v);
      }
    }
  }

  void begin(std::size_t collider, double radius_m) {
    const Collider& c = scene_.colliders[collider];
    made_.shapes.push_back({static_cast<uint>(made_.points.size()), 0, static_cast<float>(radius_m),
                            static_cast<float>(made_.margins_m.back()), static_cast<float>(c.friction),
                            c.moves() ? 1u : 0u, static_cast<uint>(made_.sources.size()), 0});
  }

  void point(const Vec3& at) {
    const auto x = [&](std::size_t d) { return static_cast<float>(at[d] - origin_[d]); };
    made_.points.push_back({{x(0), x(1), x(2), 0}, {x(0), x(1), x(2), 0}});
    made_.max_points = std::max(made_.max_points, ++made_.shapes.back().count);
  }

  void from_capsule(const Vec3& at) {
    made_.sources.push_back({static_cast<uint>(made_.points.size()), capsule_ends_++, 1});
    point(at);
  }

  void add_boxes() {
    const auto around = [](ShapeAabb& box, const vec4& low, const vec4& high) {
      box.low = {std::min(box.low.x, low.x), std::min(box.low.y, low.y), std::min(box.low.z, low.z), 0};
      box.high = {std::max(box.high.x, high.x), std::max(box.high.y, high.y), std::max(box.high.z, high.z), 0};
    };
    constexpr float kFar = 1e30f;
    const ShapeAabb none{{kFar, kFar, kFar, 0}, {-kFar, -kFar, -kFar, 0}};
    std::vector<ShapeAabb> groups;
    for (std::size_t k = 0; k < made_.shapes.size(); ++k) {
      const ConvexShape& shape = made_.shapes[k];
      const float more = shape.radius + shape.margin;
      ShapeAabb box = none;
      for (std::size_t j = shape.first; j < shape.first + shape.count; ++j) {
        const vec4& at = made_.points[j].start;
        around(box, {at.x - more, at.y - more, at.z - more, 0}, {at.x + more, at.y + more, at.z + more, 0});
      }
      if (k % SHAPES_PER_GROUP == 0) groups.push_back(none);
      around(groups.back(), box.low, box.high);
      made_.boxes.push_back(box);
    }
    made_.boxes.insert(made_.boxes.end(), groups.begin(), groups.end());
  }

  const Scene& scene_;
  const Vec3 origin_;
  const ColliderBuffers* colliders_;
  ConvexShapes made_;
  uint capsule_ends_ = 0;
};

}  // namespace

Clusters cluster(const std::vector<double>& positions, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<Vec3> centroids;
  for (const auto& t : triangles) {
    Vec3& c = centroids.emplace_back(Vec3{});
    for (const std::uint32_t v : t)
      for (std::size_t k = 0; k < 3; ++k) c[k] += positions[3 * v + k] / 3;
  }
  Clusters result;
  result.triangles.resize(triangles.size());
  std::iota(result.triangles.begin(), result.triangles.end(), 0u);
  split(centroids, result.triangles.begin(), result.triangles.end(), result.sizes);
  return result;
}

ConvexShapes convex_shapes(const Scene& scene, Vec3 origin_m, const ColliderBuffers* colliders) {
  return Maker(scene, origin_m, colliders).all();
}

}  // namespace clothbench::pbd_gpu
