#include "metrics/collider_passage.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <set>
#include <utility>

#include "clothbench/record.hpp"
#include "metrics/centre_line.hpp"
#include "metrics/collider_contact.hpp"
#include "metrics/collider_surface.hpp"
#include "metrics/collider_touch.hpp"
#include "metrics/contact/pierce.hpp"
#include "metrics/contact/touch.hpp"
#include "metrics/contact/wrong_side.hpp"

namespace clothbench {
namespace {

using contact::Bone;
using contact::Point;
using contact::WrongSide;

/// Whether a segment meets a collider in a pose. Built at the first question, which few frames ask.
class Crossing {
 public:
  Crossing(const Collider& c, const ColliderPose& pose) : collider_(c), pose_(pose) {}

  bool operator()(const Point<3>& p, const Point<3>& q) {
    const ColliderKind& kind = kind_of(collider_);
    if (kind.capsules != nullptr) {
      if (capsules_.empty()) capsules_ = contact_capsules(kind.capsules(collider_, pose_));
      return std::any_of(capsules_.begin(), capsules_.end(), [&](const contact::Capsule& c) {
        return contact::squared_distance(p, q, c.a, c.b) < c.radius_m * c.radius_m;
      });
    }
    if (!tree_) {
      const ColliderSurface surface = kind.surface(collider_, pose_, {});
      tree_.emplace(contact::TriangleMeshView{surface.positions, surface.triangles});
    }
    bool met = false;
    tree_->tree().for_each_overlapping(contact::Box(p).extend(q), [&](int t) {
      met = met || contact::crossing<3>(p, q, tree_->triangles()[static_cast<std::size_t>(t)]) != 0;
    });
    return met;
  }

 private:
  const Collider& collider_;
  const ColliderPose& pose_;
  std::vector<contact::Capsule> capsules_;
  std::optional<contact::TriangleTree> tree_;
};

}  // namespace

struct ColliderPassage::Watch {
  Watch(const Scene& s, const std::vector<double>& held_at_m)
      : scene(s), touch(s, held_at_m), triangles(clothbench::triangles(s.cloth)) {
    for (const Collider& c : s.colliders) {
      lines.emplace_back(c);
      sides.emplace_back();
    }
    if (std::none_of(s.colliders.begin(), s.colliders.end(), has_centre_line)) return;
    find_samples();
    for (std::size_t k = 0; k < s.colliders.size(); ++k)
      if (has_centre_line(s.colliders[k])) watch_side(k, initial_positions(s));
  }

  void find_samples() {
    const Cloth& c = scene.cloth;
    for (int j = 0; j + 1 < c.rows; ++j)
      for (int i = 0; i + 1 < c.columns; ++i) {
        const auto v = static_cast<std::uint32_t>(j * c.columns + i), row = static_cast<std::uint32_t>(c.columns);
        cells.push_back({v, v + 1, v + row, v + row + 1});
      }
    for (const auto& cell : cells)
      cell_area.push_back((c.line_u_m(static_cast<int>(cell[1] % static_cast<std::uint32_t>(c.columns))) -
                           c.line_u_m(static_cast<int>(cell[0] % static_cast<std::uint32_t>(c.columns)))) *
                          c.dv());
    const std::vector<double> rest = initial_positions(scene);
    vertex_area = contact::vertex_areas({rest, triangles});
  }

  const ColliderPose& pose(std::size_t collider, int frame) const {
    static const ColliderPose nowhere;
    const FrameMotion* motion = scene.motion_after(frame - 1);
    return motion ? motion->colliders[collider] : nowhere;
  }

  void watch_side(std::size_t k, const std::vector<double>& start) {
    const std::vector<Bone> bones = lines[k].at(pose(k, 0));
    if (bones.empty()) return;
    Point<3> middle = Point<3>::Zero(), sheet = Point<3>::Zero();
    for (const Bone& b : bones) middle += (b[0] + b[1]) / (2.0 * static_cast<double>(bones.size()));
    for (std::size_t v = 0; v < start.size(); v += 3)
      sheet += Point<3>(Point<3>::Map(&start[v])) * (3.0 / static_cast<double>(start.size()));
    const Point<3> normal = contact::point(scene.cloth.axis_u).cross(contact::point(scene.cloth.axis_v)).normalized();
    const double reach = 4 * (scene.cloth.width_m + scene.cloth.height_m + (middle - sheet).norm());
    sides[k].emplace(bones, normal.dot(middle - sheet) < 0 ? Point<3>(-normal) : normal, reach,
                     vertex_area.size() + cells.size(), links());
  }

  /// Sides of cells and of triangles, and from a cell's corners to its centre.
  std::vector<contact::Link> links() const {
    std::set<contact::Link> sides_of_cells;
    const auto add = [&](std::uint32_t a, std::uint32_t b) { sides_of_cells.insert({std::min(a, b), std::max(a, b)}); };
    for (const auto& [a, b, c, d] : cells) add(a, b), add(c, d), add(a, c), add(b, d);
    if (scene.cloth.mesh)
      for (const auto& [a, b, c] : scene.cloth.mesh->triangles) add(a, b), add(b, c), add(c, a);
    std::vector<contact::Link> out(sides_of_cells.begin(), sides_of_cells.end());
    for (std::size_t k = 0; k < cells.size(); ++k)
      for (const std::uint32_t v : cells[k]) out.push_back({v, static_cast<std::uint32_t>(vertex_area.size() + k)});
    return out;
  }

  std::vector<double> samples_of(const std::vector<double>& x) const {
    std::vector<double> out = x;
    for (const auto& cell : cells)
      for (std::size_t k = 0; k < 3; ++k)
        out.push_back((x[3 * cell[0] + k] + x[3 * cell[1] + k] + x[3 * cell[2] + k] + x[3 * cell[3] + k]) / 4);
    return out;
  }

  /// `contours_m`: length of the contour with each collider in this frame.
  void probe_sides(int frame, const std::vector<double>& x, const std::vector<double>& contours_m, ScenePassage& out) {
    const bool any = std::any_of(sides.begin(), sides.end(), [](const auto& s) { return s.has_value(); });
    if (!any) return;
    const std::vector<double> samples = samples_of(x), before = std::exchange(contours_before, contours_m);
    for (std::size_t k = 0; k < sides.size(); ++k) {
      if (!sides[k]) continue;
      Crossing crosses(scene.colliders[k], pose(k, frame));
      const bool contour = contours_m[k] > 0 || (!before.empty() && before[k] > 0);
      sides[k]->advance(samples, lines[k].at(pose(k, frame)), {contour, std::ref(crosses)});
      if (!sides[k]->known()) return;
    }
    out.wrong_side_samples = out.laid_over_samples = 0;
    double all = 0, lost = 0;
    for (std::size_t i = 0; i < samples.size() / 3; ++i) {
      const double area = i < vertex_area.size() ? vertex_area[i] : cell_area[i - vertex_area.size()];
      const auto is = [&](bool (WrongSide::*what)(std::size_t) const) {
        return std::any_of(sides.begin(), sides.end(), [&](const auto& s) { return s && (*s.*what)(i); });
      };
      all += area;
      if (is(&WrongSide::wrong)) {
        lost += area;
        out.wrong_side_samples += 1;
      } else if (is(&WrongSide::laid_over)) {
        out.laid_over_samples += 1;
      }
    }
    out.wrong_side_fraction = lost / all;
  }

  void probe_axes(int frame, const std::vector<double>& x, ScenePassage& out) const {
    for (std::size_t k = 0; k < sides.size(); ++k) {
      const std::vector<Bone> axes = lines[k].at(pose(k, frame));
      if (axes.empty()) continue;
      if (!(out.hooked_axes >= 0)) out.hooked_axes = 0;
      out.hooked_axes += static_cast<double>(contact::pierced({x, triangles}, axes));
    }
  }

  const Scene& scene;
  ColliderTouch touch;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<std::uint32_t, 4>> cells;
  std::vector<double> vertex_area, cell_area;
  std::vector<CentreLine> lines;
  std::vector<std::optional<WrongSide>> sides;  ///< one per collider; empty if it has no centre line
  std::vector<double> contours_before;          ///< [m], one per collider; empty before the first frame
};

ColliderPassage::ColliderPassage(const Scene& scene, const std::vector<double>& held_at_m)
    : watch_(std::make_unique<Watch>(scene, held_at_m)) {}
ColliderPassage::~ColliderPassage() = default;

ScenePassage ColliderPassage::probe(int frame, const std::vector<double>& positions,
                                    const std::vector<double>& contours_m) {
  ScenePassage out{kMissing, kMissing, kMissing, kMissing, kMissing, kMissing};
  watch_->probe_sides(frame, positions, contours_m, out);
  if (!contact::all_finite(positions)) {
    watch_->touch.skip();
    return out;
  }
  watch_->probe_axes(frame, positions, out);
  watch_->touch.probe(frame, positions, out);
  return out;
}

}  // namespace clothbench
