#include "metrics/contact/winding.hpp"

#include <cmath>
#include <numbers>

#include "metrics/contact/tunnel.hpp"

namespace clothbench::contact {
namespace {

constexpr double kFourPi = 4 * std::numbers::pi;
/// A cluster counts as far beyond this many radii. A larger value is slower and nearer to the full sum.
constexpr double kFar = 3;
/// Estimates nearer to 1/2 than this are not trusted.
constexpr double kDoubt = 0.2;

/// Signed solid angle of a triangle seen from p, positive from behind (van Oosterom & Strackee 1983, eq. 8).
double solid_angle(const Point<3>& p, const Simplex<3>& v) {
  const Point<3> a = v[0] - p, b = v[1] - p, c = v[2] - p;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

}  // namespace

double winding_number(const Point<3>& p, const TriangleTree& mesh) {
  double sum = 0;
  for (const Simplex<3>& triangle : mesh.triangles()) sum += solid_angle(p, triangle);
  return sum / kFourPi;
}

InsideTest::InsideTest(const TriangleTree& mesh, bool closed) : mesh_(mesh), closed_(closed) {
  if (!closed_) build_clusters();
}

/// The hierarchy lists a node after its children, so one pass in order sees them first.
void InsideTest::build_clusters() {
  const auto& hierarchy = mesh_.tree().hierarchy();
  clusters_.resize(hierarchy.getRootIndex() + 1);
  for (int node = 0; node < static_cast<int>(clusters_.size()); ++node) {
    Cluster& cluster = clusters_[node];
    BoxTree::Hierarchy::VolumeIterator volume = nullptr, volume_end = nullptr;
    BoxTree::Hierarchy::ObjectIterator item = nullptr, item_end = nullptr;
    hierarchy.getChildren(node, volume, volume_end, item, item_end);
    for (; item != item_end; ++item) {
      const Simplex<3>& v = mesh_.triangles()[*item];
      const Point<3> area_vector = 0.5 * (v[1] - v[0]).cross(v[2] - v[0]);
      cluster.area_vector += area_vector;
      cluster.area += area_vector.norm();
      cluster.centre += area_vector.norm() * (v[0] + v[1] + v[2]) / 3;
    }
    for (; volume != volume_end; ++volume) {
      const Cluster& child = clusters_[*volume];
      cluster.area_vector += child.area_vector;
      cluster.area += child.area;
      cluster.centre += child.area * child.centre;
    }
    const Box& box = hierarchy.getVolume(node);
    cluster.centre = cluster.area > 0 ? Point<3>(cluster.centre / cluster.area) : Point<3>(box.center());
    const Point<3> reach = (cluster.centre - box.min()).cwiseMax(box.max() - cluster.centre);
    cluster.radius = reach.norm();
  }
}

double InsideTest::clustered_winding_number(const Point<3>& p) const {
  if (clusters_.empty()) return winding_number(p, mesh_);
  double sum = 0;
  std::vector<int> stack{static_cast<int>(clusters_.size()) - 1};
  while (!stack.empty()) {
    const int node = stack.back();
    stack.pop_back();
    const Cluster& cluster = clusters_[node];
    const Point<3> r = cluster.centre - p;
    const double distance = r.norm();
    if (distance > kFar * cluster.radius) {
      sum += cluster.area_vector.dot(r) / (distance * distance * distance);
      continue;
    }
    BoxTree::Hierarchy::VolumeIterator volume = nullptr, volume_end = nullptr;
    BoxTree::Hierarchy::ObjectIterator item = nullptr, item_end = nullptr;
    mesh_.tree().hierarchy().getChildren(node, volume, volume_end, item, item_end);
    for (; volume != volume_end; ++volume) stack.push_back(*volume);
    for (; item != item_end; ++item) sum += solid_angle(p, mesh_.triangles()[*item]);
  }
  return sum / kFourPi;
}

/// The ray follows the axis that leaves the mesh's box soonest, so the ray's box is the ray itself.
int InsideTest::crossings_to_infinity(const Point<3>& p) const {
  const Box& box = mesh_.tree().box();
  if (mesh_.triangles().empty() || !box.contains(p)) return 0;
  int axis = 0;
  bool up = true;
  double least = box.max()[0] - p[0];
  for (int k = 0; k < 3; ++k) {
    if (box.max()[k] - p[k] < least) axis = k, up = true, least = box.max()[k] - p[k];
    if (p[k] - box.min()[k] < least) axis = k, up = false, least = p[k] - box.min()[k];
  }
  Point<3> outside = p;
  outside[axis] = up ? box.max()[axis] + box.diagonal().norm() : box.min()[axis] - box.diagonal().norm();
  return signed_crossings(p, outside, mesh_);
}

double InsideTest::estimate(const Point<3>& p) const {
  return closed_ ? crossings_to_infinity(p) : clustered_winding_number(p);
}

bool InsideTest::operator()(const Point<3>& p) const {
  const double w = estimate(p);
  if (closed_ || std::abs(w - 0.5) > kDoubt) return w > 0.5;
  return winding_number(p, mesh_) > 0.5;
}

}  // namespace clothbench::contact
