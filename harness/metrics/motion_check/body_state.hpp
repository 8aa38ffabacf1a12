#pragma once
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <memory>

#include "metrics/contact/contact_probe.hpp"
#include "metrics/contact/triangle_mesh.hpp"
#include "metrics/motion_check/motion.hpp"
#include "scenario/collider_kinds.hpp"

namespace clothbench::motion_check {

using contact::Box;
using contact::Simplex;
using Corners = std::array<std::uint32_t, 3>;

/// Tolerance of contact offsets: a tenth.
inline constexpr double kOffsetFactor = 1.1;
inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// A segment of an object's centre line: the axis of a capsule, or a bone of a hand.
using Bone = std::array<V3, 2>;

/// A point of a hand's centre line that moves with one joint.
struct MedialPoint {
  std::size_t joint;
  V3 at_rest;
};

/// The centre line of one collider in any pose: the axes of its capsules or, for a hand mesh, segments through the
/// centres of the flesh around the joints of each finger. Empty for other colliders.
class CentreLine {
 public:
  explicit CentreLine(const Collider& c);
  std::vector<Bone> at(const ColliderPose& pose) const;

 private:
  std::vector<std::array<MedialPoint, 2>> bones_;
};

/// A collider in one frame.
struct Pose {
  std::size_t frame = 0;
  std::vector<Capsule> capsules;
  std::vector<double> positions;
  std::vector<std::uint32_t> near;         ///< triangles that may be within reach of the cloth
  std::unique_ptr<contact::BoxTree> tree;  ///< over the triangles in `near`
  std::vector<bool> noted;                 ///< per triangle in `near`: whether it is already a contact of the frame
};

struct Body {
  const Collider& collider;
  const ColliderKind& kind;
  double offset_m;
  CentreLine line;
  double radius_m = kInfinite;
  std::vector<double> lengths_m = {};  ///< of its capsules' axes at the start
  std::vector<Corners> triangles = {};
  std::array<std::unique_ptr<Pose>, 4> poses = {};
  std::array<std::pair<std::size_t, double>, 4> displacements = {};  ///< (frame, displacement [m] in it)
  std::unique_ptr<contact::TriangleTree> still = nullptr;            ///< the surface of a static mesh
  std::unique_ptr<contact::TriangleTree> middle = nullptr;           ///< the middle plane of a box
  std::vector<double> middle_positions = {};
  std::vector<Corners> middle_triangles = {};
  std::vector<V3> inner = {};  ///< points deep inside a static body

  bool moves() const { return collider.moves(); }
};

/// Gives a plate its middle plane, inset from its border by half the thickness. A bar gets none.
void add_middle(Body& b);

inline Box box_of(std::span<const double> positions) {
  Box box;
  for (std::size_t v = 0; v < positions.size() / 3; ++v) box.extend(V3(V3::Map(positions.data() + 3 * v)));
  return box;
}

struct AllBodies final : Bodies {
  AllBodies(const Motion& motion, std::span<const double> contact_offsets_m);

  bool empty() const override { return bodies.empty(); }
  bool any_moves() const override { return std::any_of(bodies.begin(), bodies.end(), std::mem_fn(&Body::moves)); }
  double speed() const override { return highest_speed; }
  std::span<const Contact> contacts(std::size_t frame) override;
  bool touched(std::size_t frame, std::size_t v) const override { return !reached[frame].empty() && reached[frame][v]; }
  Face face(std::size_t frame) const override { return faces[frame]; }
  double depth_ratio(std::size_t frame) const override { return depth[frame]; }
  bool near(std::size_t frame, std::span<const V3> points, double displacement_m) override;
  int passages(std::size_t frame) override;

  Pose& pose(Body& b, std::size_t frame);
  double displacement(Body& b, std::size_t frame);
  void touch(Body& b, std::size_t frame, const std::vector<V3>& x, const std::vector<double>& reach);
  void touch_plane(const Body& b, const std::vector<V3>& x, const std::vector<double>& reach);
  void touch_capsules(Body& b, std::size_t frame, const std::vector<V3>& x, const std::vector<double>& reach, bool any);
  void touch_surface(Body& b, std::size_t frame, const std::vector<V3>& x, const std::vector<double>& reach, bool any);
  void touch_triangle(Body& b, Pose& p, const Corners& corners, const std::vector<V3>& x, double reach, bool any);
  void note(const V3& point, const V3& normal, const Body& b, bool any) {
    found->push_back({point, normal, b.collider.friction, any || !(normal.squaredNorm() > 0.5)});
  }
  std::vector<V3> inner_points(Body& b, std::size_t frame);
  int through_cloth(std::size_t frame, const std::vector<V3>& from, const std::vector<V3>& to);
  int through_surface(std::size_t frame, const contact::TriangleTree& tree, std::span<const double> positions,
                      std::span<const Corners> triangles);
  std::vector<double> cloth(std::size_t frame) const;

  const Motion& m;
  std::vector<Body> bodies;
  double highest_speed = 0;
  std::vector<contact::Link> links;
  std::vector<std::uint32_t> each;  ///< 0, 1, 2, ...
  std::map<std::size_t, std::vector<Contact>> kept;
  std::vector<Contact>* found = nullptr;
  std::vector<bool>* flags = nullptr;
  std::vector<std::vector<bool>> reached;
  std::vector<double> depth;
  std::vector<Face> faces;
};

inline V3 point_of(const Simplex<3>& t, const V3& weights) {
  return weights[0] * t[0] + weights[1] * t[1] + weights[2] * t[2];
}

/// Nearest points of two segments: on the first, on the second (Ericson, Real-Time Collision Detection, 5.1.9).
inline std::array<V3, 2> nearest_of_segments(const V3& a, const V3& b, const V3& c, const V3& d) {
  const V3 u = b - a, v = d - c, w = a - c;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const auto unit = [](double x) { return std::clamp(x, 0.0, 1.0); };
  const double parallel = uu * vv - uv * uv;
  double s = parallel > 1e-12 * uu * vv ? unit((uv * vw - uw * vv) / parallel) : 0;
  double t = vv > 0 ? unit((uv * s + vw) / vv) : 0;
  s = uu > 0 ? unit((uv * t - uw) / uu) : 0;
  t = vv > 0 ? unit((uv * s + vw) / vv) : 0;
  return {a + s * u, c + t * v};
}

/// Keeps the nearest of several pairs of points.
struct NearestPair {
  std::array<V3, 2> best;
  double least = kInfinite;
  void keep(const std::array<V3, 2>& pair) {
    const double d = (pair[0] - pair[1]).squaredNorm();
    if (d < least) least = d, best = pair;
  }
};

/// Nearest points of a triangle and a segment that do not cross: on the triangle, on the segment.
inline std::array<V3, 2> nearest_of(const Simplex<3>& t, const V3& a, const V3& b) {
  NearestPair out{{t[0], a}};
  out.keep({point_of(t, contact::nearest_weights(a, t)), a});
  out.keep({point_of(t, contact::nearest_weights(b, t)), b});
  for (std::size_t i = 0; i < 3; ++i) out.keep(nearest_of_segments(t[i], t[(i + 1) % 3], a, b));
  return out.best;
}

/// Nearest points of two triangles that do not cross: on the first, on the second. Ignores edges of `s` outside `box`.
inline std::array<V3, 2> nearest_of_triangles(const Simplex<3>& t, const Simplex<3>& s, const Box& box) {
  NearestPair out{{t[0], s[0]}};
  for (std::size_t k = 0; k < 3; ++k) {
    out.keep({t[k], point_of(s, contact::nearest_weights(t[k], s))});
    if (!box.intersects(Box(s[k].cwiseMin(s[(k + 1) % 3]), s[k].cwiseMax(s[(k + 1) % 3])))) continue;
    out.keep(nearest_of(t, s[k], s[(k + 1) % 3]));
  }
  return out.best;
}

/// Nearest points if a triangle lies on one side of the plane of `s`; `lowest`: its vertex nearest to that plane. If
/// this vertex projects into `s`, no other point is nearer.
inline std::array<V3, 2> nearest_to_plane(const Simplex<3>& t, const Simplex<3>& s, std::size_t lowest,
                                          const Box& box) {
  const V3 weights = contact::nearest_weights(t[lowest], s);
  if (weights.minCoeff() > 0) return {t[lowest], point_of(s, weights)};
  return nearest_of_triangles(t, s, box);
}

}  // namespace clothbench::motion_check
