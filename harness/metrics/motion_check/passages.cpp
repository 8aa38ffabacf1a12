// Passages between two stored frames: inner points of solids through the cloth, vertices through static surfaces.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "metrics/motion_check/body_state.hpp"

namespace clothbench::motion_check {
namespace {

/// First and last joints of the fingers, in the order of the WebXR Hand Input module.
constexpr std::array<std::array<std::size_t, 2>, 5> kFingers = {{{1, 4}, {5, 9}, {10, 14}, {15, 19}, {20, 24}}};

constexpr double kDetour = 1.25;  // length of a path around a rim over the straight one

constexpr std::size_t kHandJoints = 25;  // of the WebXR Hand Input module

double weight_of(const ColliderMesh& m, std::size_t vertex, std::size_t joint) {
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k)
    if (m.joints[vertex][k] == joint) sum += static_cast<double>(m.weights[vertex][k]);
  return sum;
}

/// Centres of the flesh around each joint's bone: means of its vertices, weighted by skinning weights. The last point
/// lies half-way to the tip: flesh reaches the fingertip, but there is no next bone.
std::vector<MedialPoint> medial_points(const ColliderMesh& m, std::size_t first, std::size_t last) {
  std::vector<MedialPoint> out;
  for (std::size_t j = first; j <= last; ++j) {
    V3 sum = V3::Zero();
    double all = 0;
    for (std::size_t v = 0; v < m.vertex_count(); ++v) {
      const double w = weight_of(m, v, j);
      sum += w * contact::point_at(m.positions, v);
      all += w;
    }
    if (all >= 1) out.push_back({j, sum / all});
  }
  if (out.size() < 2) return {};
  const std::size_t end = out.back().joint;
  const V3 middle = out.back().at_rest, along = (middle - out[out.size() - 2].at_rest).normalized();
  double ahead = 0;
  for (std::size_t v = 0; v < m.vertex_count(); ++v)
    if (weight_of(m, v, end) >= 0.5) ahead = std::max(ahead, along.dot(contact::point_at(m.positions, v) - middle));
  if (ahead > 0) out.push_back({end, middle + 0.5 * ahead * along});
  return out;
}

V3 posed(const MedialPoint& m, const ColliderPose& pose) {
  V3 out;
  for (std::size_t row = 0; row < 3; ++row) {
    const auto& r = pose.joints[m.joint][row];
    out[static_cast<int>(row)] = r[0] * m.at_rest[0] + r[1] * m.at_rest[1] + r[2] * m.at_rest[2] + r[3];
  }
  return out;
}

}  // namespace

CentreLine::CentreLine(const Collider& c) {
  if (!c.mesh || !c.mesh->skinned() || c.mesh->joint_count != kHandJoints) return;
  for (const auto& [first, last] : kFingers) {
    const std::vector<MedialPoint> points = medial_points(*c.mesh, first, last);
    for (std::size_t k = 1; k < points.size(); ++k) bones_.push_back({points[k - 1], points[k]});
  }
}

std::vector<Bone> CentreLine::at(const ColliderPose& pose) const {
  std::vector<Bone> out;
  for (const Capsule& c : pose.capsules) out.push_back({to_v3(c.a_m), to_v3(c.b_m)});
  for (const auto& [a, b] : bones_) out.push_back({posed(a, pose), posed(b, pose)});
  return out;
}

void add_middle(Body& b) {
  const Vec3& half = b.collider.half_extent_m;
  const std::size_t thin = static_cast<std::size_t>(std::min_element(half.begin(), half.end()) - half.begin());
  const std::size_t u = (thin + 1) % 3, v = (thin + 2) % 3;
  if (!(half[u] > b.radius_m && half[v] > b.radius_m)) return;
  for (const auto& [i, j] : {std::array{-1, -1}, std::array{1, -1}, std::array{1, 1}, std::array{-1, 1}}) {
    const V3 at = to_v3(b.collider.center_m) + i * (half[u] - b.radius_m) * to_v3(b.collider.axes[u]) +
                  j * (half[v] - b.radius_m) * to_v3(b.collider.axes[v]);
    b.middle_positions.insert(b.middle_positions.end(), {at[0], at[1], at[2]});
  }
  b.middle_triangles = {{0, 1, 2}, {0, 2, 3}};
  b.middle = std::make_unique<contact::TriangleTree>(contact::TriangleMeshView{b.middle_positions, b.middle_triangles});
}

/// Points deep inside a solid, half a cell apart (at most 33 in a row). None of them may pass through the cloth.
std::vector<V3> AllBodies::inner_points(Body& b, std::size_t frame) {
  std::vector<V3> out;
  const auto count = [&](double length) {
    return std::clamp(static_cast<int>(std::ceil(2 * length / m.cell_m)), 1, 32);
  };
  if (b.kind.capsules != nullptr) {
    const std::vector<Capsule>& capsules = pose(b, frame).capsules;
    for (std::size_t i = 0; i < capsules.size(); ++i) {
      const V3 a = to_v3(capsules[i].a_m), along = to_v3(capsules[i].b_m) - a;
      const int n = count(b.lengths_m[i]);
      for (int j = 0; j <= n; ++j) out.push_back(a + static_cast<double>(j) / n * along);
    }
  }
  if (b.collider.shape == Collider::Shape::Box) {
    const Vec3& half = b.collider.half_extent_m;
    std::array<int, 3> n{};
    for (std::size_t k = 0; k < 3; ++k) n[k] = count(2 * (half[k] - b.radius_m));
    for (int i = 0; i <= n[0]; ++i)
      for (int j = 0; j <= n[1]; ++j)
        for (int k = 0; k <= n[2]; ++k) {
          V3 at = to_v3(b.collider.center_m);
          const std::array<int, 3> index{i, j, k};
          for (std::size_t a = 0; a < 3; ++a)
            at += (2.0 * index[a] / n[a] - 1) * (half[a] - b.radius_m) * to_v3(b.collider.axes[a]);
          out.push_back(at);
        }
  }
  if (b.moves() && b.kind.capsules == nullptr) {
    const std::size_t index = static_cast<std::size_t>(&b - bodies.data());
    const std::vector<Bone> rest = b.line.at(m.scripted(0)->colliders[index]);
    const std::vector<Bone> bones = b.line.at(m.scripted(frame)->colliders[index]);
    for (std::size_t i = 0; i < bones.size(); ++i) {
      const int n = count((rest[i][1] - rest[i][0]).norm());
      for (int j = 0; j <= n; ++j)
        out.push_back(bones[i][0] + static_cast<double>(j) / n * (bones[i][1] - bones[i][0]));
    }
  }
  return out;
}

/// Number of points that pass the cloth in all three orders of motion: points first, cloth first, both at once.
int AllBodies::through_cloth(std::size_t frame, const std::vector<V3>& from, const std::vector<V3>& to) {
  Box swept, path;
  for (std::size_t v = 0; v < m.vertices; ++v) {
    swept.extend(m.at(frame - 1, v));
    swept.extend(m.at(frame, v));
  }
  for (std::size_t i = 0; i < from.size(); ++i) path.extend(from[i]).extend(to[i]);
  if (from.empty() || !swept.intersects(path)) return 0;
  std::vector<Corners> close;
  for (const Corners& t : m.triangles) {
    Box sweep;
    for (const std::uint32_t v : t) sweep.extend(m.at(frame - 1, v)).extend(m.at(frame, v));
    if (sweep.intersects(path)) close.push_back(t);
  }
  if (close.empty()) return 0;
  const std::vector<double> was = cloth(frame - 1), now = cloth(frame);
  const contact::TriangleMeshView before{was, close}, after{now, close};
  const contact::SweptMesh mesh(before, after, each);
  std::unique_ptr<contact::TriangleTree> at_start, at_end;
  int count = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const int evenly = mesh.signed_crossings(from[i], to[i]);
    if (evenly == 0) continue;
    if (!at_start) {
      at_start = std::make_unique<contact::TriangleTree>(before);
      at_end = std::make_unique<contact::TriangleTree>(after);
    }
    const int first = contact::signed_crossings(from[i], to[i], *at_start) + mesh.signed_crossings(to[i], to[i]);
    const int last = mesh.signed_crossings(from[i], from[i]) + contact::signed_crossings(from[i], to[i], *at_end);
    if (first == evenly && last == evenly) ++count;
  }
  return count;
}

/// Number of vertices that pass a static surface: through it, or in and out through faces with opposite normals.
int AllBodies::through_surface(std::size_t frame, const contact::TriangleTree& tree, std::span<const double> positions,
                               std::span<const Corners> triangles) {
  const std::vector<double> was = cloth(frame - 1), now = cloth(frame);
  Box swept;
  swept.extend(box_of(was)).extend(box_of(now));
  if (!swept.intersects(tree.tree().box())) return 0;
  const std::vector<Simplex<3>>& faces = tree.triangles();
  const auto normal = [&](int t) {
    return V3((faces[t][1] - faces[t][0]).cross(faces[t][2] - faces[t][0]).normalized());
  };
  const auto faces_met = [&](const V3& p, const V3& q) {
    std::vector<int> met;
    tree.tree().for_each_overlapping(Box(p).extend(q), [&](int t) {
      if (contact::crossing<3>(p, q, faces[t]) != 0) met.push_back(t);
    });
    return met;
  };
  // The straight path cuts a rim that the vertex slid around: a path with one bend, kDetour times as long, is free.
  const auto cuts_rim = [&](const V3& p, const V3& q) {
    const V3 along = q - p, side = along.unitOrthogonal(), other = along.normalized().cross(side);
    constexpr int kPlaces = 8, kDirections = 16;
    for (int i = 1; i < kPlaces; ++i)
      for (int k = 0; k < kDirections; ++k) {
        const double place = static_cast<double>(i) / kPlaces, angle = 2 * std::numbers::pi * k / kDirections;
        const double off_centre = (2 * place - 1) / kDetour;  // on an ellipsoid with the foci p and q
        const double width = along.norm() / 2 * std::sqrt((kDetour * kDetour - 1) * (1 - off_centre * off_centre));
        const V3 bend = p + place * along + width * (std::cos(angle) * side + std::sin(angle) * other);
        if (faces_met(p, bend).empty() && faces_met(bend, q).empty()) return true;
      }
    return false;
  };
  int through = 0;
  bool any = false;
  for (std::size_t v = 0; v < m.vertices; ++v) {
    const V3 p = contact::point_at(was, v), q = contact::point_at(now, v);
    if (p == q) continue;
    const std::vector<int> met = faces_met(p, q);
    any = any || !met.empty();
    bool opposed = false;
    for (const int a : met)
      for (const int b : met) opposed = opposed || normal(a).dot(normal(b)) < -0.5;
    through += opposed && !cuts_rim(p, q);
  }
  if (!any) return 0;
  for (const int n : contact::proven_crossings(was, now, {positions, triangles}, tree, links)) through += n != 0;
  return through;
}

int AllBodies::passages(std::size_t frame) {
  int count = 0;
  for (Body& b : bodies) {
    if (b.kind.half_space) continue;
    if (b.moves()) {
      count += through_cloth(frame, inner_points(b, frame - 1), inner_points(b, frame));
    } else {
      if (b.inner.empty()) b.inner = inner_points(b, 0);
      count += through_cloth(frame, b.inner, b.inner);
    }
    if (b.still && b.collider.shape != Collider::Shape::Box)
      count += through_surface(frame, *b.still, pose(b, 0).positions, b.triangles);
    if (b.middle) count += through_surface(frame, *b.middle, b.middle_positions, b.middle_triangles);
  }
  return count;
}

bool AllBodies::near(std::size_t frame, std::span<const V3> points, double displacement_m) {
  Box cloth;
  for (const V3& p : points) cloth.extend(p);
  for (Body& b : bodies) {
    const double reach = displacement_m + kOffsetFactor * b.offset_m + 4 * m.resolution_m + displacement(b, frame);
    if (b.kind.half_space) {
      for (const V3& p : points)
        if (to_v3(b.collider.normal).dot(p - to_v3(b.collider.center_m)) < reach) return true;
      continue;
    }
    Box box;
    const Pose& now = pose(b, frame);
    for (const Capsule& c : now.capsules)
      for (const Vec3& end : {c.a_m, c.b_m}) box.extend(contact::grown(Box(to_v3(end)), c.radius_m));
    if (!now.positions.empty()) box.extend(box_of(now.positions));
    if (contact::grown(box, reach).intersects(cloth)) return true;
  }
  return false;
}

}  // namespace clothbench::motion_check
