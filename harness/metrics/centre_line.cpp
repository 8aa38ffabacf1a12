#include "metrics/centre_line.hpp"

#include <algorithm>

namespace clothbench {
namespace {

using contact::Bone;
using contact::Point;

/// First and last joints of the fingers, in the order of the WebXR Hand Input module.
constexpr std::array<std::array<std::size_t, 2>, 5> kFingers = {{{1, 4}, {5, 9}, {10, 14}, {15, 19}, {20, 24}}};

constexpr std::size_t kHandJoints = 25;  // of the WebXR Hand Input module

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

Point<3> posed(const MedialPoint& m, const ColliderPose& pose) {
  Point<3> out;
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
  for (const Capsule& c : pose.capsules) out.push_back({contact::point(c.a_m), contact::point(c.b_m)});
  for (const auto& [a, b] : bones_) out.push_back({posed(a, pose), posed(b, pose)});
  return out;
}

}  // namespace clothbench
