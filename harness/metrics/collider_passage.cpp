#include "metrics/collider_passage.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "clothbench/record.hpp"
#include "metrics/collider_contact.hpp"
#include "metrics/collider_surface.hpp"
#include "metrics/contact/wrong_side.hpp"

namespace clothbench {
namespace {

constexpr double kTouchShare = 1e-3;  // of the cloth's shorter side, beyond the margin
constexpr double kTouchMargin = 0.1;  // of the margin

using contact::Bone;
using contact::Nearest;
using contact::Point;
using contact::WrongSide;

/// A point of a hand's centre line that moves with one joint.
struct MedialPoint {
  std::size_t joint;
  Point<3> at_rest;
};

/// First and last joints of the fingers, in the order of the WebXR Hand Input module.
constexpr std::array<std::array<std::size_t, 2>, 5> kFingers = {{{1, 4}, {5, 9}, {10, 14}, {15, 19}, {20, 24}}};

double weight_of(const ColliderMesh& m, std::size_t vertex, std::size_t joint) {
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k)
    if (m.joints[vertex][k] == joint) sum += static_cast<double>(m.weights[vertex][k]);
  return sum;
}

/// The middle of the flesh round each joint's bone: the mean of its vertices, weighted by skinning weights. The last
/// point lies half-way on to the tip, where there is flesh up to the fingertip but no next bone.
std::vector<MedialPoint> medial_points(const ColliderMesh& m, std::size_t first, std::size_t last) {
  std::vector<MedialPoint> out;
  for (std::size_t j = first; j <= last; ++j) {
    Point<3> sum = Point<3>::Zero();
    double all = 0;
    for (std::size_t v = 0; v < m.vertex_count(); ++v) {
      const double w = weight_of(m, v, j);
      sum += w * Point<3>(Point<3>::Map(m.positions.data() + 3 * v));
      all += w;
    }
    if (all >= 1) out.push_back({j, sum / all});
  }
  if (out.size() < 2) return {};
  const std::size_t end = out.back().joint;
  const Point<3> middle = out.back().at_rest, along = (middle - out[out.size() - 2].at_rest).normalized();
  double ahead = 0;
  for (std::size_t v = 0; v < m.vertex_count(); ++v)
    if (weight_of(m, v, end) >= 0.5)
      ahead = std::max(ahead, along.dot(Point<3>(Point<3>::Map(m.positions.data() + 3 * v)) - middle));
  if (ahead > 0) out.push_back({end, middle + 0.5 * ahead * along});
  return out;
}

/// The centre line of one collider in any pose.
class CentreLine {
 public:
  explicit CentreLine(const Collider& c) {
    if (!c.mesh || !has_centre_line(c)) return;
    for (const auto& [first, last] : kFingers) {
      const std::vector<MedialPoint> points = medial_points(*c.mesh, first, last);
      for (std::size_t k = 1; k < points.size(); ++k) bones_.push_back({points[k - 1], points[k]});
    }
  }

  std::vector<Bone> at(const ColliderPose& pose) const {
    std::vector<Bone> out;
    for (const Capsule& c : pose.capsules) out.push_back({contact::point(c.a_m), contact::point(c.b_m)});
    for (const auto& [a, b] : bones_) out.push_back({posed(a, pose), posed(b, pose)});
    return out;
  }

 private:
  static Point<3> posed(const MedialPoint& m, const ColliderPose& pose) {
    Point<3> out;
    for (std::size_t row = 0; row < 3; ++row) {
      const auto& r = pose.joints[m.joint][row];
      out[static_cast<int>(row)] = r[0] * m.at_rest[0] + r[1] * m.at_rest[1] + r[2] * m.at_rest[2] + r[3];
    }
    return out;
  }
  std::vector<std::array<MedialPoint, 2>> bones_;
};

/// The triangles of a collider at one instant.
struct Triangles {
  Triangles(const Collider& c, const ColliderPose& pose)
      : surface(kind_of(c).surface(c, pose, {})), near({surface.positions, surface.triangles}) {}
  Triangles(const Triangles&) = delete;
  Triangles& operator=(const Triangles&) = delete;

  ColliderSurface surface;
  contact::NearSurface near;
};

}  // namespace

struct ColliderPassage::Watch {
  Watch(const Scene& s, const std::vector<double>& held_at_m) : scene(s) {
    for (std::size_t k = 0; k < s.colliders.size(); ++k) {
      const bool reported = k < held_at_m.size() && std::isfinite(held_at_m[k]);
      margins.push_back(reported ? held_at_m[k] : s.colliders[k].margin_m);
    }
    tolerance = kTouchShare * std::min(s.cloth.width_m, s.cloth.height_m);
    const Cloth& c = s.cloth;
    for (int j = 0; j + 1 < c.rows; ++j)
      for (int i = 0; i + 1 < c.columns; ++i) {
        const auto v = static_cast<std::uint32_t>(j * c.columns + i), row = static_cast<std::uint32_t>(c.columns);
        cells.push_back({v, v + 1, v + row, v + row + 1});
      }
    std::vector<double> start = initial_positions(s);
    vertex_area.assign(c.vertex_count(), 0);
    for (const auto& cell : cells) {
      const double area = (c.line_u_m(static_cast<int>(cell[1] % static_cast<std::uint32_t>(c.columns))) -
                           c.line_u_m(static_cast<int>(cell[0] % static_cast<std::uint32_t>(c.columns)))) *
                          c.dv();
      cell_area.push_back(area);
      for (const std::uint32_t v : cell) vertex_area[v] += area / 4;
    }
    if (c.mesh) vertex_area = vertex_masses(s);  // density is uniform and only ratios are used
    for (std::size_t k = 0; k < s.colliders.size(); ++k) {
      lines.emplace_back(s.colliders[k]);
      sides.emplace_back();
      still.emplace_back();
      if (!ClosedForm::has(s.colliders[k]) && !s.colliders[k].moves())
        still[k] = std::make_unique<Triangles>(s.colliders[k], ColliderPose{});
      touched.emplace_back(c.vertex_count(), 0);
      if (has_centre_line(s.colliders[k])) watch_side(k, start);
    }
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
                     vertex_area.size() + cells.size(), weave());
  }

  /// Links: sides of cells and of triangles, and from a cell's corners to its centre.
  contact::Weave weave() const {
    std::map<contact::Link, int> edges;
    const auto add = [&](std::uint32_t a, std::uint32_t b) { ++edges[{std::min(a, b), std::max(a, b)}]; };
    for (const auto& [a, b, c, d] : cells) add(a, b), add(c, d), add(a, c), add(b, d);
    if (scene.cloth.mesh)
      for (const auto& [a, b, c] : scene.cloth.mesh->triangles) add(a, b), add(b, c), add(c, a);
    contact::Weave out{{}, std::vector<bool>(vertex_area.size() + cells.size(), false)};
    for (const auto& [edge, faces] : edges) {
      out.links.push_back(edge);
      if (faces == 1) out.border[edge[0]] = out.border[edge[1]] = true;
    }
    for (std::size_t k = 0; k < cells.size(); ++k)
      for (const std::uint32_t v : cells[k]) {
        out.links.push_back({v, static_cast<std::uint32_t>(vertex_area.size() + k)});
        if (out.border[v]) out.border[vertex_area.size() + k] = true;
      }
    return out;
  }

  std::vector<double> samples_of(const std::vector<double>& x) const {
    std::vector<double> out = x;
    for (const auto& cell : cells)
      for (std::size_t k = 0; k < 3; ++k)
        out.push_back((x[3 * cell[0] + k] + x[3 * cell[1] + k] + x[3 * cell[2] + k] + x[3 * cell[3] + k]) / 4);
    return out;
  }

  void probe_sides(int frame, const std::vector<double>& x, ScenePassage& out) {
    const bool any = std::any_of(sides.begin(), sides.end(), [](const auto& s) { return s.has_value(); });
    if (!any) return;
    out.wrong_side_fraction = out.wrong_side_samples = 0;
    const std::vector<double> samples = samples_of(x);
    std::vector<bool> wrong(samples.size() / 3, false);
    for (std::size_t k = 0; k < sides.size(); ++k) {
      if (!sides[k]) continue;
      sides[k]->advance(samples, lines[k].at(pose(k, frame)));
      if (!sides[k]->known()) {
        out.wrong_side_fraction = out.wrong_side_samples = kMissing;
        return;
      }
      for (std::size_t i = 0; i < wrong.size(); ++i) wrong[i] = wrong[i] || sides[k]->wrong(i);
    }
    double all = 0, lost = 0;
    for (std::size_t i = 0; i < wrong.size(); ++i) {
      const double area = i < vertex_area.size() ? vertex_area[i] : cell_area[i - vertex_area.size()];
      all += area;
      if (!wrong[i]) continue;
      lost += area;
      out.wrong_side_samples += 1;
    }
    out.wrong_side_fraction = lost / all;
  }

  /// Nearest point of collider k for every vertex within `reach`.
  std::vector<std::optional<Nearest>> near(std::size_t k, int frame, const std::vector<double>& x, double reach) const {
    const Collider& c = scene.colliders[k];
    std::vector<std::optional<Nearest>> out(x.size() / 3);
    const auto each = [&](auto find) {
      for (std::size_t v = 0; v < out.size(); ++v) out[v] = find(Point<3>(Point<3>::Map(&x[3 * v])));
    };
    const ColliderPose &now = pose(k, frame), &was = pose(k, std::max(frame - 1, 0));
    if (ClosedForm::has(c)) {
      each(ClosedForm(c, now, was));
    } else if (!c.moves()) {
      each([&](const Point<3>& p) { return still[k]->near(p, reach); });
    } else {
      const std::vector<double> last = kind_of(c).surface(c, was, {}).positions;
      const Triangles surface(c, now);
      each([&](const Point<3>& p) { return surface.near(p, reach, last); });
    }
    return out;
  }

  void probe_touch(int frame, const std::vector<double>& x, ScenePassage& out) {
    std::vector<bool> touching(x.size() / 3, false);
    double slid = 0, kept = 0;
    for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
      const double margin = margins[k];
      const double reach = margin + std::max(tolerance, kTouchMargin * margin);
      const std::vector<std::optional<Nearest>> found = near(k, frame, x, reach);
      for (std::size_t v = 0; v < found.size(); ++v) {
        const bool touch = found[v] && found[v]->distance_m <= reach;
        if (touch && touched[k][v] != 0 && !before.empty()) {
          const Point<3> way =
              Point<3>(Point<3>::Map(&x[3 * v])) - Point<3>(Point<3>::Map(&before[3 * v])) - found[v]->carried_m;
          slid += (way - found[v]->normal.dot(way) * found[v]->normal).norm();
          kept += 1;
        }
        touched[k][v] = touch;
        touching[v] = touching[v] || touch;
      }
    }
    double all = 0, part = 0;
    for (std::size_t v = 0; v < touching.size(); ++v) {
      all += vertex_area[v];
      if (touching[v]) part += vertex_area[v];
    }
    out.touching_fraction = part / all;
    out.slip_m = kept > 0 ? slid / kept : 0;
  }

  const Scene& scene;
  std::vector<std::array<std::uint32_t, 4>> cells;
  std::vector<double> vertex_area, cell_area, before;
  double tolerance = 0;
  std::vector<double> margins;  ///< one per collider: distance at which the solver holds cloth off it
  std::vector<CentreLine> lines;
  std::vector<std::optional<WrongSide>> sides;    ///< one per collider; empty if it has no centre line
  std::vector<std::vector<char>> touched;         ///< (collider, vertex), at the last frame
  std::vector<std::unique_ptr<Triangles>> still;  ///< only for static colliders made of triangles
};

ColliderPassage::ColliderPassage(const Scene& scene, const std::vector<double>& held_at_m)
    : watch_(std::make_unique<Watch>(scene, held_at_m)) {}
ColliderPassage::~ColliderPassage() = default;

ScenePassage ColliderPassage::probe(int frame, const std::vector<double>& positions) {
  ScenePassage out{kMissing, kMissing, kMissing, kMissing};
  watch_->probe_sides(frame, positions, out);
  if (!contact::all_finite(positions)) {
    watch_->before.clear();
    return out;
  }
  watch_->probe_touch(frame, positions, out);
  watch_->before = positions;
  return out;
}

}  // namespace clothbench
