#include <algorithm>
#include <cmath>
#include <optional>

#include "clothbench/error.hpp"
#include "metrics/collider_contact.hpp"
#include "metrics/contact/shapes.hpp"
#include "metrics/contact/tunnel.hpp"
#include "metrics/contact/winding.hpp"
#include "render/vertex_values.hpp"

namespace clothbench::render {
namespace {

using contact::Point;

Point<3> point(const Vec3& v) { return {v[0], v[1], v[2]}; }

double depth_in_box(const Collider& c, const Point<3>& p) {
  double depth = INFINITY;
  for (std::size_t k = 0; k < 3; ++k)
    depth = std::min(depth, c.half_extent_m[k] - std::abs(point(c.axes[k]).dot(p - point(c.center_m))));
  return depth;
}

double depth_in_capsules(const std::vector<Capsule>& capsules, const Point<3>& p) {
  double depth = -INFINITY;
  for (const Capsule& c : capsules)
    depth = std::max(depth, -contact::signed_distance(p, {point(c.a_m), point(c.b_m), c.radius_m}));
  return depth;
}

/// A mesh as it is now, and its inside where it has one.
struct Posed {
  Posed(const ColliderMesh& mesh, const ColliderPose& pose, bool solid)
      : position(posed_positions(mesh, pose)), tree({position, mesh.triangles}) {
    const contact::TriangleMeshView view{position, mesh.triangles};
    if (solid) inside.emplace(tree, contact::is_closed(view, contact::welded_vertices(view)));
  }
  double depth(const Point<3>& p) const { return tree.tree().box().contains(p) && (*inside)(p) ? tree.distance(p) : 0; }

  std::vector<double> position;
  contact::TriangleTree tree;
  std::optional<contact::InsideTest> inside;
};

struct Watched {
  const Collider* collider;
  std::unique_ptr<Posed> posed;                   ///< of a mesh that stands still
  std::optional<contact::TunnelHistory> history;  ///< of one without an inside
};

}  // namespace

struct VertexDepth::State {
  const Scene& scene;
  std::vector<Watched> watched;
  std::vector<double> before;
  bool history_known = true;

  const ColliderPose& pose(std::size_t k, int frame) const {
    static const ColliderPose kStill;
    const FrameMotion* motion = scene.motion_after(frame - 1);
    return motion != nullptr ? motion->colliders[k] : kStill;
  }

  void deepen(std::size_t k, int frame, std::span<const double> x, std::vector<float>& out) {
    Watched& w = watched[k];
    const Collider& c = *w.collider;
    std::unique_ptr<Posed> now;
    if (c.shape == Collider::Shape::Mesh && c.moves()) now = std::make_unique<Posed>(*c.mesh, pose(k, frame), true);
    const Posed* mesh = now ? now.get() : w.posed.get();
    const std::vector<Capsule>& capsules = pose(k, frame).capsules.empty() ? c.capsules : pose(k, frame).capsules;
    for (std::size_t v = 0; v < out.size(); ++v) {
      const Point<3> p(x[3 * v], x[3 * v + 1], x[3 * v + 2]);
      double depth = NAN;
      if (p.allFinite()) {
        switch (c.shape) {
          case Collider::Shape::Plane:
            depth = point(c.normal).dot(point(c.center_m) - p);
            break;
          case Collider::Shape::Sphere:
            depth = c.radius_m - (p - point(c.center_m)).norm();
            break;
          case Collider::Shape::Box:
            depth = depth_in_box(c, p);
            break;
          case Collider::Shape::Capsules:
            depth = depth_in_capsules(capsules, p);
            break;
          case Collider::Shape::Mesh:
            if (!w.history)
              depth = mesh->depth(p);
            else if (history_known)
              depth = w.history->counts()[v] != 0 ? mesh->tree.distance(p) : 0;
            break;
        }
      }
      if (!(static_cast<double>(out[v]) >= depth)) out[v] = static_cast<float>(depth);
    }
  }
};

VertexDepth::VertexDepth(const Scene& scene) : state_(new State{scene, {}, {}}) {
  for (const Collider& c : scene.colliders) {
    Watched w{&c, nullptr, {}};
    if (c.shape == Collider::Shape::Mesh) {
      const bool solid = has_inside(c);
      if (!c.moves()) w.posed = std::make_unique<Posed>(*c.mesh, ColliderPose{}, solid);
      if (!solid) w.history.emplace(scene.cloth.vertex_count());
    }
    state_->watched.push_back(std::move(w));
  }
}

VertexDepth::~VertexDepth() = default;

std::vector<float> VertexDepth::at(int frame, std::span<const double> x, bool wanted) {
  State& s = *state_;
  if (!contact::all_finite(x)) s.history_known = false;
  if (s.history_known && !s.before.empty())
    for (Watched& w : s.watched)
      if (w.history) w.history->advance(s.before, x, w.posed->tree);
  s.before.assign(x.begin(), x.end());
  if (!wanted) return {};
  std::vector<float> out(s.scene.cloth.vertex_count(), 0);
  for (std::size_t k = 0; k < s.watched.size(); ++k) s.deepen(k, frame, x, out);
  return out;
}

}  // namespace clothbench::render
