#include <algorithm>
#include <cmath>
#include <optional>

#include "metrics/collider_contact.hpp"
#include "metrics/collider_surface.hpp"
#include "metrics/contact/contour.hpp"
#include "metrics/contact/tunnel.hpp"
#include "metrics/contact/winding.hpp"
#include "render/vertex_values.hpp"

namespace clothbench::render {
namespace {

using contact::Point;

/// Triangles as they are now, and their inside where they have one.
struct Posed {
  Posed(const Collider& c, const ColliderPose& pose)
      : surface(kind_of(c).surface(c, pose, {})), tree({surface.positions, surface.triangles}) {
    const contact::TriangleMeshView view{surface.positions, surface.triangles};
    if (has_inside(c)) inside.emplace(tree, contact::is_closed(view, contact::welded_vertices(view)));
  }
  double depth(const Point<3>& p) const { return tree.tree().box().contains(p) && (*inside)(p) ? tree.distance(p) : 0; }

  ColliderSurface surface;
  contact::TriangleTree tree;
  std::optional<contact::InsideTest> inside;
};

struct Watched {
  const Collider* collider;
  std::unique_ptr<Posed> posed;                   ///< of static triangles
  std::optional<contact::TunnelHistory> history;  ///< of one without an inside
};

}  // namespace

struct VertexDepth::State {
  const Scene& scene;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< of the cloth
  std::vector<Watched> watched;
  std::vector<double> before;
  bool history_known = true;

  const ColliderPose& pose(std::size_t k, int frame) const {
    static const ColliderPose kStill;
    const FrameMotion* motion = scene.motion_after(frame - 1);
    return motion != nullptr ? motion->colliders[k] : kStill;
  }

  /// What shows that cloth between `before` and `x` went through a mesh, as in contact::ContactProbe.
  contact::StepEvidence evidence(const Posed& mesh, std::span<const double> x) const {
    const auto crosses = [&mesh, this](std::span<const double> at) {
      return contact::contour({at, triangles}, mesh.tree).length_m > 0;
    };
    return {[this, crosses, x] { return crosses(before) || crosses(x); },
            [&mesh](const Point<3>& p, const Point<3>& q) {
              const std::vector<double>& at = mesh.surface.positions;
              const contact::TriangleMeshView view{at, mesh.surface.triangles};
              return contact::Border(view, contact::welded_vertices(view)).out_of_reach(p, q, at, at);
            }};
  }

  void deepen(std::size_t k, int frame, std::span<const double> x, std::vector<float>& out) {
    Watched& w = watched[k];
    const Collider& c = *w.collider;
    std::optional<ClosedForm> closed;
    if (ClosedForm::has(c)) closed.emplace(c, pose(k, frame), pose(k, frame));
    std::unique_ptr<Posed> now;
    if (!closed && c.moves()) now = std::make_unique<Posed>(c, pose(k, frame));
    const Posed* mesh = now ? now.get() : w.posed.get();
    for (std::size_t v = 0; v < out.size(); ++v) {
      const Point<3> p(x[3 * v], x[3 * v + 1], x[3 * v + 2]);
      double depth = NAN;
      if (p.allFinite()) {
        if (closed)
          depth = -(*closed)(p).distance_m;
        else if (!w.history)
          depth = mesh->depth(p);
        else if (history_known)
          depth = w.history->counts()[v] != 0 ? mesh->tree.distance(p) : 0;
      }
      if (!(static_cast<double>(out[v]) >= depth)) out[v] = static_cast<float>(depth);
    }
  }
};

VertexDepth::VertexDepth(const Scene& scene) : state_(new State{scene, clothbench::triangles(scene.cloth), {}, {}}) {
  for (const Collider& c : scene.colliders) {
    Watched w{&c, nullptr, {}};
    if (!ClosedForm::has(c)) {
      if (!c.moves()) w.posed = std::make_unique<Posed>(c, ColliderPose{});
      if (!has_inside(c)) w.history.emplace(scene.cloth.vertex_count(), contact::edges_of(state_->triangles));
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
      if (w.history) w.history->advance(s.before, x, w.posed->tree, s.evidence(*w.posed, x));
  s.before.assign(x.begin(), x.end());
  if (!wanted) return {};
  std::vector<float> out(s.scene.cloth.vertex_count(), 0);
  for (std::size_t k = 0; k < s.watched.size(); ++k) s.deepen(k, frame, x, out);
  return out;
}

}  // namespace clothbench::render
