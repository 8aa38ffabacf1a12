#include "metrics/collider_contact.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "metrics/contact/contact_probe.hpp"
#include "metrics/contact/triangle_mesh.hpp"
#include "scenario/collider_kinds.hpp"

namespace clothbench {
namespace {

constexpr double kTouchShare = 1e-3;  // fraction of the cloth's shorter side, added to the contact offset
constexpr double kTouchMargin = 0.1;  // fraction of the contact offset, added instead if larger

using contact::Nearest;
using contact::Point;
using contact::TriangleMeshView;
using contact::TriangleTree;

class Probes final : public ColliderContact {
 public:
  Probes(const Scene& s, const std::vector<double>& held_at_m)
      : scene(s),
        triangles(clothbench::triangles(s.cloth)),
        links(contact::edges_of(triangles)),
        meshes(s.colliders.size()) {
    const double tolerance = kTouchShare * std::min(s.cloth.width_m, s.cloth.height_m);
    for (std::size_t k = 0; k < s.colliders.size(); ++k) {
      const Collider& c = s.colliders[k];
      any_inside |= has_inside(c);
      const double margin = k < held_at_m.size() && std::isfinite(held_at_m[k]) ? held_at_m[k] : c.margin_m;
      reach_m.push_back(margin + std::max(tolerance, kTouchMargin * margin));
      touched.emplace_back(s.cloth.vertex_count(), 0);
      if (kind_of(c).capsules != nullptr || kind_of(c).half_space) continue;
      try {
        place(k, 0);
      } catch (const Error& e) {
        throw Error("collider " + c.name + ": " + e.what());
      }
    }
    const std::vector<double> rest = initial_positions(s);
    for (std::size_t t = 0; t < triangles.size(); ++t)
      area.push_back(contact::area(TriangleMeshView{rest, triangles}.triangle(t)));
  }

  SceneContact probe(int frame, const std::vector<double>& positions) override {
    advance(frame);
    SceneContact all{0, any_inside ? 0 : kMissing};
    for (std::size_t k = 0; k < meshes.size(); ++k) {
      const contact::ContactSample s = sample(k, frame, positions);
      all.length_m += s.contour_length_m;
      if (has_inside(scene.colliders[k])) all.depth_m = max_or_nan(all.depth_m, s.depth_max_m);
    }
    return all;
  }

  SceneTouch touch(int frame, const std::vector<double>& x) override {
    if (!contact::all_finite(x)) {
      before.clear();
      return {kMissing, kMissing};
    }
    advance(frame);
    std::vector<bool> touching(triangles.size(), false);
    double slid = 0, kept = 0;
    for (std::size_t k = 0; k < meshes.size(); ++k) {
      const std::vector<std::optional<Nearest>> found = near(k, frame, x);
      for (std::size_t v = 0; v < found.size(); ++v) {
        if (found[v] && touched[k][v] != 0 && !before.empty()) {
          const Point<3> way = contact::point_at(x, v) - contact::point_at(before, v) - found[v]->carried_m;
          slid += (way - found[v]->normal.dot(way) * found[v]->normal).norm();
          kept += 1;
        }
        touched[k][v] = found[v].has_value();
      }
      for (std::size_t t = 0; t < triangles.size(); ++t)
        for (const std::uint32_t v : triangles[t]) touching[t] = touching[t] || touched[k][v];
      touch_between(k, frame, x, [&](std::size_t t) { touching[t] = true; });
    }
    double all = 0, part = 0;
    for (std::size_t t = 0; t < touching.size(); ++t) {
      all += area[t];
      if (touching[t]) part += area[t];
    }
    before = x;
    return {part / all, kept > 0 ? slid / kept : 0};
  }

 private:
  /// Pose of a collider at the end of a frame, 0 = the start.
  const ColliderPose& pose_at(std::size_t k, int frame) const {
    static const ColliderPose still;
    const FrameMotion* motion = scene.motion_after(frame - 1);
    return motion ? motion->colliders[k] : still;
  }

  void place(std::size_t k, int frame) {
    const Collider& c = scene.colliders[k];
    const ColliderSurface surface = kind_of(c).surface(c, pose_at(k, frame), {});
    meshes[k] = std::make_unique<TriangleTree>(TriangleMeshView{surface.positions, surface.triangles});
  }

  /// Moves the surfaces of kinematic mesh colliders to their poses at the end of `frame`.
  void advance(int frame) {
    if (frame == placed) return;
    for (std::size_t k = 0; k < meshes.size(); ++k)
      if (meshes[k] && scene.colliders[k].moves()) place(k, frame);
    placed = frame;
  }

  std::vector<contact::Capsule> capsules_at(std::size_t k, int frame) const {
    const Collider& collider = scene.colliders[k];
    std::vector<contact::Capsule> out;
    for (const Capsule& c : kind_of(collider).capsules(collider, pose_at(k, frame)))
      out.push_back({contact::point(c.a_m), contact::point(c.b_m), c.radius_m});
    return out;
  }

  contact::ContactSample sample(std::size_t k, int frame, const std::vector<double>& positions) const {
    const Collider& c = scene.colliders[k];
    const TriangleMeshView cloth{positions, triangles};
    if (kind_of(c).half_space)
      return contact::half_space_contact(cloth, contact::point(c.center_m), contact::point(c.normal));
    if (kind_of(c).capsules != nullptr) return contact::capsule_contact(cloth, capsules_at(k, frame));
    return contact::mesh_contact(cloth, links, *meshes[k], has_inside(c));
  }

  /// For every vertex, the nearest point of collider k if it is at most reach_m[k] away.
  std::vector<std::optional<Nearest>> near(std::size_t k, int frame, const std::vector<double>& x) const {
    const Collider& c = scene.colliders[k];
    const ColliderKind& kind = kind_of(c);
    std::vector<std::optional<Nearest>> out(x.size() / 3);
    const auto each = [&](auto find) {
      for (std::size_t v = 0; v < out.size(); ++v) {
        const std::optional<Nearest> found = find(contact::point_at(x, v));
        if (found && found->distance_m <= reach_m[k]) out[v] = found;
      }
    };
    const int previous = std::max(frame - 1, 0);
    if (kind.nearest != nullptr) {
      each([&](const Point<3>& p) {
        const SurfacePlace found = kind.nearest(c, {p[0], p[1], p[2]});
        return Nearest{found.distance_m, contact::point(found.normal), Point<3>::Zero()};
      });
    } else if (kind.capsules != nullptr) {
      const std::vector<contact::Capsule> now = capsules_at(k, frame), was = capsules_at(k, previous);
      each([&](const Point<3>& p) { return contact::nearest(p, now, was); });
    } else if (!c.moves()) {
      each([&](const Point<3>& p) { return contact::nearest(p, *meshes[k], reach_m[k]); });
    } else {
      const ColliderSurface last = kind.surface(c, pose_at(k, previous), {});
      const TriangleMeshView was{last.positions, last.triangles};
      each([&](const Point<3>& p) { return contact::nearest(p, *meshes[k], reach_m[k], &was); });
    }
    return out;
  }

  /// Marks triangles that touch collider k although none of their vertices does. A half-space has no such triangle.
  template <class Mark>
  void touch_between(std::size_t k, int frame, const std::vector<double>& x, Mark mark) const {
    const ColliderKind& kind = kind_of(scene.colliders[k]);
    if (kind.half_space) return;
    const TriangleMeshView cloth{x, triangles};
    std::vector<contact::Capsule> capsules;
    std::vector<contact::Box> boxes;
    contact::Box all;
    if (kind.capsules != nullptr) capsules = capsules_at(k, frame);
    for (const contact::Capsule& s : capsules)
      all.extend(boxes.emplace_back(contact::grown(contact::Box(s.a).extend(s.b), reach_m[k] + s.radius_m)));
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const auto& [p, q, r] = triangles[t];
      if (touched[k][p] || touched[k][q] || touched[k][r]) continue;
      const contact::Simplex<3> face = cloth.triangle(t);
      const contact::Box box = contact::box_of(face);
      bool touches = meshes[k] && contact::within(face, *meshes[k], reach_m[k]);
      if (!capsules.empty() && box.intersects(all))
        for (std::size_t i = 0; i < capsules.size() && !touches; ++i)
          touches = box.intersects(boxes[i]) && contact::within(face, capsules[i], reach_m[k]);
      if (touches) mark(t);
    }
  }

  const Scene& scene;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<contact::Link> links;
  std::vector<std::unique_ptr<TriangleTree>> meshes;  ///< one per collider, in frame `placed`; null without triangles
  int placed = 0;
  bool any_inside = false;
  std::vector<double> area;                ///< of the triangles, at rest
  std::vector<double> reach_m;             ///< one per collider: maximum distance at which cloth touches it
  std::vector<std::vector<char>> touched;  ///< (collider, vertex): whether it touched at the last frame
  std::vector<double> before;  ///< positions at the last frame; empty at the start and after non-finite positions
};

}  // namespace

std::unique_ptr<ColliderContact> collider_contact(const Scene& scene, const std::vector<double>& held_at_m) {
  return std::make_unique<Probes>(scene, held_at_m);
}

SelfContact self_contact(const std::vector<double>& positions,
                         const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  if (!contact::all_finite(positions)) return {kMissing, kMissing};
  const contact::Contour c = contact::self_contour({positions, triangles});
  return {c.length_m, static_cast<double>(c.pairs)};
}

}  // namespace clothbench
