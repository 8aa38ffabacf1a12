#include "metrics/collider_touch.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "clothbench/record.hpp"
#include "metrics/contact/surface.hpp"
#include "metrics/metric.hpp"

namespace clothbench {
namespace {

constexpr double kTouchShare = 1e-3;  // of the cloth's shorter side, beyond the margin
constexpr double kTouchMargin = 0.1;  // of the margin

using contact::Nearest;
using contact::Point;

}  // namespace

struct ColliderTouch::Watch {
  Watch(const Scene& s, const std::vector<double>& held_at_m)
      : scene(s), triangles(clothbench::triangles(s.cloth)), vertices(s.cloth.vertex_count()) {
    const double tolerance = kTouchShare * std::min(s.cloth.width_m, s.cloth.height_m);
    for (std::size_t k = 0; k < s.colliders.size(); ++k) {
      const Collider& c = s.colliders[k];
      const double margin = k < held_at_m.size() && std::isfinite(held_at_m[k]) ? held_at_m[k] : c.margin_m;
      reach_m.push_back(margin + std::max(tolerance, kTouchMargin * margin));
      const bool flat = kind_of(c).surface != nullptr && !kind_of(c).half_space;
      still.push_back(flat && !c.moves() ? triangles_of(c, {}) : nullptr);
      touched.emplace_back(vertices, 0);
    }
    const std::vector<double> rest = initial_positions(s);
    for (std::size_t t = 0; t < triangles.size(); ++t)
      area.push_back(contact::area(contact::TriangleMeshView{rest, triangles}.triangle(t)));
  }

  /// Nearest point of collider k for every vertex within reach. `moved`: its triangles, if it is a mesh that moves.
  std::vector<std::optional<Nearest>> near(std::size_t k, int frame, const std::vector<double>& x,
                                           const contact::TriangleTree* moved) const {
    const Collider& c = scene.colliders[k];
    std::vector<std::optional<Nearest>> out(vertices);
    const auto each = [&](auto find) {
      for (std::size_t v = 0; v < vertices; ++v) {
        const std::optional<Nearest> found = find(Point<3>(Point<3>::Map(&x[3 * v])));
        if (found && found->distance_m <= reach_m[k]) out[v] = found;
      }
    };
    const ColliderPose& was = pose_at(scene, k, std::max(frame - 1, 0));
    if (ClosedForm::has(c)) {
      each(ClosedForm(c, pose_at(scene, k, frame), was));
    } else if (moved == nullptr) {
      each([&](const Point<3>& p) { return contact::nearest(p, *still[k], reach_m[k]); });
    } else {
      const ColliderSurface last = kind_of(c).surface(c, was, {});
      const contact::TriangleMeshView before{last.positions, last.triangles};
      each([&](const Point<3>& p) { return contact::nearest(p, *moved, reach_m[k], &before); });
    }
    return out;
  }

  /// Triangles none of whose vertices touches collider k, but an edge or the face does. A half-space has none.
  template <class Mark>
  void touch_between(std::size_t k, int frame, const std::vector<double>& x, const contact::TriangleTree* moved,
                     Mark mark) const {
    const Collider& c = scene.colliders[k];
    const ColliderKind& kind = kind_of(c);
    if (kind.half_space) return;
    const contact::TriangleMeshView cloth{x, triangles};
    const Point<3> margin = Point<3>::Constant(reach_m[k]);
    std::vector<contact::Capsule> capsules;
    std::vector<contact::Box> boxes;
    contact::Box all;
    if (kind.capsules != nullptr) capsules = contact_capsules(kind.capsules(c, pose_at(scene, k, frame)));
    for (const contact::Capsule& s : capsules) {
      contact::Box box = contact::Box(s.a).extend(s.b);
      const Point<3> out = margin + Point<3>::Constant(s.radius_m);
      all.extend(boxes.emplace_back(box.min() - out, box.max() + out));
    }
    const contact::TriangleTree* surface = still[k] ? still[k].get() : moved;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const auto& [p, q, r] = triangles[t];
      if (touched[k][p] || touched[k][q] || touched[k][r]) continue;
      const contact::Simplex<3> face = cloth.triangle(t);
      const contact::Box box = contact::Box(face[0]).extend(face[1]).extend(face[2]);
      bool touches = capsules.empty() && surface != nullptr && contact::within(face, *surface, reach_m[k]);
      if (!capsules.empty() && box.intersects(all))
        for (std::size_t i = 0; i < capsules.size() && !touches; ++i)
          touches = box.intersects(boxes[i]) && contact::within(face, capsules[i], reach_m[k]);
      if (touches) mark(t);
    }
  }

  const Scene& scene;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::size_t vertices;
  std::vector<double> area;                ///< of the triangles, at rest
  std::vector<double> reach_m;             ///< one per collider: up to this distance cloth touches it
  std::vector<std::vector<char>> touched;  ///< (collider, vertex), at the last frame
  std::vector<std::unique_ptr<contact::TriangleTree>>
      still;  ///< only for static colliders that have triangles and an end
};

ColliderTouch::ColliderTouch(const Scene& scene, const std::vector<double>& held_at_m)
    : watch_(std::make_unique<Watch>(scene, held_at_m)) {}
ColliderTouch::~ColliderTouch() = default;

SceneTouch ColliderTouch::probe(int frame, const std::vector<double>& x) {
  if (!contact::all_finite(x)) {
    before_.clear();
    return {kMissing, kMissing};
  }
  Watch& w = *watch_;
  std::vector<bool> touching(w.triangles.size(), false);
  double slid = 0, kept = 0;
  for (std::size_t k = 0; k < w.scene.colliders.size(); ++k) {
    const Collider& c = w.scene.colliders[k];
    const bool moves = !ClosedForm::has(c) && c.moves();
    const auto moved = moves ? triangles_of(c, pose_at(w.scene, k, frame)) : nullptr;
    const std::vector<std::optional<Nearest>> found = w.near(k, frame, x, moved.get());
    for (std::size_t v = 0; v < found.size(); ++v) {
      if (found[v] && w.touched[k][v] != 0 && !before_.empty()) {
        const Point<3> way =
            Point<3>(Point<3>::Map(&x[3 * v])) - Point<3>(Point<3>::Map(&before_[3 * v])) - found[v]->carried_m;
        slid += (way - found[v]->normal.dot(way) * found[v]->normal).norm();
        kept += 1;
      }
      w.touched[k][v] = found[v].has_value();
    }
    for (std::size_t t = 0; t < w.triangles.size(); ++t)
      for (const std::uint32_t v : w.triangles[t]) touching[t] = touching[t] || w.touched[k][v];
    w.touch_between(k, frame, x, moved.get(), [&](std::size_t t) { touching[t] = true; });
  }
  double all = 0, part = 0;
  for (std::size_t t = 0; t < touching.size(); ++t) {
    all += w.area[t];
    if (touching[t]) part += w.area[t];
  }
  before_ = x;
  return {part / all, kept > 0 ? slid / kept : 0};
}

std::vector<contact::Capsule> contact_capsules(const std::vector<Capsule>& capsules) {
  std::vector<contact::Capsule> out;
  for (const Capsule& c : capsules) out.push_back({contact::point(c.a_m), contact::point(c.b_m), c.radius_m});
  return out;
}

const ColliderPose& pose_at(const Scene& scene, std::size_t collider, int frame) {
  static const ColliderPose still;
  const FrameMotion* motion = scene.motion_after(frame - 1);
  return motion ? motion->colliders[collider] : still;
}

std::unique_ptr<contact::TriangleTree> triangles_of(const Collider& c, const ColliderPose& pose) {
  const ColliderSurface surface = kind_of(c).surface(c, pose, {});
  return std::make_unique<contact::TriangleTree>(contact::TriangleMeshView{surface.positions, surface.triangles});
}

ClosedForm::ClosedForm(const Collider& c, const ColliderPose& now, const ColliderPose& was)
    : collider_(c), kind_(kind_of(c)) {
  if (kind_.nearest != nullptr) return;
  now_ = contact_capsules(kind_.capsules(c, now));
  was_ = contact_capsules(kind_.capsules(c, was));
}

contact::Nearest ClosedForm::operator()(const contact::Point<3>& p) const {
  if (kind_.nearest == nullptr) return contact::nearest(p, now_, was_);
  const SurfacePlace found = kind_.nearest(collider_, {p[0], p[1], p[2]});
  return {found.distance_m, contact::point(found.normal), contact::Point<3>::Zero()};
}

}  // namespace clothbench
