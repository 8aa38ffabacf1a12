#pragma once
#include <array>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "metrics/centre_line.hpp"
#include "metrics/contact/surface.hpp"
#include "metrics/contact/tunnel.hpp"
#include "metrics/motion_check/bodies.hpp"
#include "scenario/collider_kinds.hpp"

namespace clothbench::motion_check {

using contact::Box;
using contact::Simplex;
using Corners = std::array<std::uint32_t, 3>;

/// Contact offsets are met to a tenth.
inline constexpr double kOffsetFactor = 1.1;
inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// A collider in one frame.
struct Pose {
  std::size_t frame = 0;
  std::vector<Capsule> capsules;
  std::vector<double> positions;
  std::vector<std::uint32_t> near;         ///< triangles that may be within reach of the cloth
  std::unique_ptr<contact::BoxTree> tree;  ///< of those
  std::vector<bool> noted;                 ///< of those: which are contacts of the frame already
};

struct Body {
  const Collider& collider;
  const ColliderKind& kind;
  double offset_m;
  CentreLine line;
  double radius_m = kInfinite;
  std::vector<double> lengths_m = {};  ///< of its capsules at the start
  std::vector<Corners> triangles = {};
  std::array<std::unique_ptr<Pose>, 4> poses = {};
  std::array<std::pair<std::size_t, double>, 4> displacements = {};  ///< [m] by frame, from the frame before it
  std::unique_ptr<contact::TriangleTree> still = nullptr;            ///< the surface of a static mesh
  std::unique_ptr<contact::TriangleTree> middle = nullptr;           ///< the middle plane of a box
  std::vector<double> middle_positions = {};
  std::vector<Corners> middle_triangles = {};
  std::vector<V3> inner = {};  ///< points deep inside, of a body at rest

  bool moves() const { return collider.moves(); }
};

/// Gives a plate its middle plane, as far from its border as from its faces. A bar, which is no thinner one way than
/// another, has none.
void add_middle(Body& b);

inline Box box_of(std::span<const double> positions) {
  Box box;
  for (std::size_t v = 0; v < positions.size() / 3; ++v) box.extend(V3(V3::Map(positions.data() + 3 * v)));
  return box;
}

struct Bodies::State {
  State(const Motion& motion, std::span<const double> contact_offsets_m);

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
  double speed = 0;
  std::vector<contact::Link> links;
  std::vector<std::uint32_t> each;  ///< 0, 1, 2, ...
  std::map<std::size_t, std::vector<Contact>> contacts;
  std::vector<Contact>* found = nullptr;
  std::vector<bool>* flags = nullptr;
  std::vector<std::vector<bool>> touched;
  std::vector<double> depth;
  std::vector<Face> faces;
};

}  // namespace clothbench::motion_check
