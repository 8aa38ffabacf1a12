#include "metrics/contact/contact_probe.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "clothbench/record.hpp"
#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {
namespace {

/// Depth [m] of a triangle in a capsule; 0 or less if it is outside.
double depth_in(const Simplex<3>& triangle, const Capsule& c) {
  // Most capsules are far away; comparing boxes first is cheaper. The factor covers rounding.
  const double apart = box_of(triangle).squaredExteriorDistance(Box(c.a).extend(c.b));
  if (apart > c.radius_m * c.radius_m * (1 + 1e-12)) return 0;
  return c.radius_m - std::sqrt(squared_distance(c.a, c.b, triangle));
}

/// Whether a point on capsule `own` is inside another one. A surface that capsules share belongs to the first of them.
bool hidden(const Point<3>& p, std::span<const Capsule> shapes, std::size_t own) {
  for (std::size_t k = 0; k < shapes.size(); ++k)
    if (k != own && signed_distance(p, shapes[k]) < (k < own ? 0 : -kCapsuleError * shapes[k].radius_m)) return true;
  return false;
}

double depth_in_mesh(const TriangleMeshView& cloth, std::span<const Link> links, const TriangleTree& mesh) {
  double most = 0;
  const auto at = [&](const Point<3>& p) {
    if (is_inside(p, mesh)) most = std::max(most, mesh.distance(p));
  };
  for (std::size_t v = 0; v < cloth.vertex_count(); ++v) at(cloth.vertex(v));
  for (const auto& [a, b] : links) at(0.5 * (cloth.vertex(a) + cloth.vertex(b)));
  for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
    const Simplex<3> v = cloth.triangle(t);
    at((v[0] + v[1] + v[2]) / 3);
  }
  return most;
}

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Triangle_3 to_cgal(const Simplex<3>& v) {
  const auto point = [](const Point<3>& p) { return Kernel::Point_3(p[0], p[1], p[2]); };
  return {point(v[0]), point(v[1]), point(v[2])};
}

/// Intersection of segment p-q with the plane of the triangle; p and q lie on different sides.
Point<3> point_of_crossing(const Point<3>& p, const Point<3>& q, const Simplex<3>& v) {
  const Point<3> normal = (v[1] - v[0]).cross(v[2] - v[0]);
  const double height_p = std::abs(normal.dot(p - v[0])), height_q = std::abs(normal.dot(q - v[0]));
  // If the sum of the heights is rounding noise, so is each of them, and any point between p and q is accurate enough.
  const double share = height_p + height_q > 0 ? height_p / (height_p + height_q) : 0.5;
  return p + share * (q - p);
}

void add_pair(Contour& to, const Simplex<3>& cloth, const Simplex<3>& object) {
  if (!CGAL::do_intersect(to_cgal(cloth), to_cgal(object))) return;
  ++to.pairs;
  if (const auto cut = intersection(cloth, object)) to.length_m += ((*cut)[1] - (*cut)[0]).norm();
}

Point<4> at_time(const Point<3>& p, double t) { return {p[0], p[1], p[2], t}; }

/// Whether a coordinate axis separates the motion p -> q from the triangle that moves from `from` to `to`. Both motions
/// are linear, so a strict separation at start and end holds in between, and a translation by e changes nothing.
bool separated_by_coordinate(const Point<3>& p, const Point<3>& q, const Simplex<3>& from, const Simplex<3>& to) {
  for (int k = 0; k < 3; ++k) {
    const auto [low_from, high_from] = std::minmax({from[0][k], from[1][k], from[2][k]});
    const auto [low_to, high_to] = std::minmax({to[0][k], to[1][k], to[2][k]});
    if ((p[k] < low_from && q[k] < low_to) || (p[k] > high_from && q[k] > high_to)) return true;
  }
  return false;
}

/// Border edges of a mesh: edges of one triangle only.
std::vector<Link> border_of(const TriangleMeshView& mesh) {
  const std::vector<std::uint32_t> welded = welded_vertices(mesh);
  std::map<Link, int> passes;
  for (const auto& corner : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = welded[corner[i]], b = welded[corner[(i + 1) % 3]];
      if (a != b) passes[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  std::vector<Link> out;
  for (const auto& [edge, sum] : passes)
    if (sum != 0) out.push_back(edge);
  return out;
}

bool crosses(const Point<3>& p, const Point<3>& q, const TriangleTree& mesh) {
  bool any = false;
  mesh.tree().for_each_overlapping(
      Box(p).extend(q), [&](int t) { any = any || (p != q && crossing<3>(p, q, mesh.triangles()[t]) != 0); });
  return any;
}

}  // namespace

ContactSample mesh_contact(const TriangleMeshView& cloth, std::span<const Link> links, const TriangleTree& mesh,
                           bool has_inside) {
  if (!all_finite(cloth.positions)) return {kMissing, kMissing};
  return {contour(cloth, mesh).length_m, has_inside ? depth_in_mesh(cloth, links, mesh) : kMissing};
}

ContactSample capsule_contact(const TriangleMeshView& cloth, std::span<const Capsule> shapes) {
  if (!all_finite(cloth.positions)) return {kMissing, kMissing};
  ContactSample out{0, 0};
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    std::vector<Simplex<3>> within;
    for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
      const Simplex<3> triangle = cloth.triangle(t);
      const double depth = depth_in(triangle, shapes[k]);
      if (!(depth > 0)) continue;
      out.depth_max_m = std::max(out.depth_max_m, depth);
      if (!is_degenerate(triangle)) within.push_back(triangle);
    }
    if (within.empty()) continue;
    const TriangleTree surface(capsule_mesh(shapes[k]).view());
    for (const Simplex<3>& triangle : within)
      surface.tree().for_each_overlapping(box_of(triangle), [&](int facet) {
        const auto cut = intersection(triangle, surface.triangles()[static_cast<std::size_t>(facet)]);
        if (cut && !hidden(0.5 * ((*cut)[0] + (*cut)[1]), shapes, k))
          out.contour_length_m += ((*cut)[1] - (*cut)[0]).norm();
      });
  }
  return out;
}

ContactSample half_space_contact(const TriangleMeshView& cloth, const Point<3>& on_plane, const Point<3>& normal) {
  if (!all_finite(cloth.positions)) return {kMissing, kMissing};
  ContactSample out{0, 0};
  const auto depth_of = [&](const Point<3>& p) { return normal.dot(on_plane - p); };
  for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
    const Simplex<3> v = cloth.triangle(t);
    const std::array<double, 3> f{depth_of(v[0]), depth_of(v[1]), depth_of(v[2])};
    for (const double d : f) out.depth_max_m = std::max(out.depth_max_m, d);
    const auto behind = std::count_if(f.begin(), f.end(), [](double d) { return d > 0; });
    if (behind == 0 || behind == 3) continue;
    // `lone` is the only corner on its side.
    std::size_t lone = 0;
    while ((f[lone] > 0) != (behind == 1)) ++lone;
    const auto cut = [&](std::size_t k) { return Point<3>(v[lone] + f[lone] / (f[lone] - f[k]) * (v[k] - v[lone])); };
    out.contour_length_m += (cut((lone + 2) % 3) - cut((lone + 1) % 3)).norm();
  }
  return out;
}

// Each end of the intersection segment is where an edge of one triangle crosses the other triangle.
std::optional<std::array<Point<3>, 2>> intersection(const Simplex<3>& cloth, const Simplex<3>& object) {
  std::array<Point<3>, 6> ends;
  int count = 0;
  const auto collect = [&](const Simplex<3>& edges, const Simplex<3>& face, int shift) {
    for (int i = 0; i < 3; ++i) {
      const Point<3>&p = edges[i], &q = edges[(i + 1) % 3];
      if (crossing<3>(p, q, face, shift) != 0) ends[count++] = point_of_crossing(p, q, face);
    }
  };
  collect(cloth, object, 1);
  // Translating the cloth is equivalent to translating the object in the opposite direction.
  collect(object, cloth, -1);
  if (count != 2) return std::nullopt;
  return std::array{ends[0], ends[1]};
}

Contour contour(const TriangleMeshView& cloth, const TriangleTree& object) {
  Contour result;
  for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
    const Simplex<3> triangle = cloth.triangle(t);
    const Box box = box_of(triangle);
    if (!box.intersects(object.tree().box()) || is_degenerate(triangle)) continue;
    object.tree().for_each_overlapping(box, [&](int other) { add_pair(result, triangle, object.triangles()[other]); });
  }
  return result;
}

Contour self_contour(const TriangleMeshView& cloth) {
  const TriangleTree mesh(cloth);
  Contour result;
  for (std::size_t k = 0; k < mesh.triangles().size(); ++k) {
    const auto& corners = cloth.triangles[mesh.numbers()[k]];
    mesh.tree().for_each_overlapping(mesh.tree().item_boxes()[k], [&](int other) {
      const auto o = static_cast<std::size_t>(other);
      const auto& others = cloth.triangles[mesh.numbers()[o]];
      const bool adjacent =
          std::find_first_of(corners.begin(), corners.end(), others.begin(), others.end()) != corners.end();
      if (o > k && !adjacent) add_pair(result, mesh.triangles()[k], mesh.triangles()[o]);  // each pair once
    });
  }
  return result;
}

int signed_crossings(const Point<3>& p, const Point<3>& q, const TriangleTree& mesh) {
  if (p == q) return 0;
  int sum = 0;
  mesh.tree().for_each_overlapping(Box(p).extend(q), [&](int t) { sum += crossing<3>(p, q, mesh.triangles()[t]); });
  return sum;
}

/// The ray follows the axis along which it leaves the mesh's box soonest, because an axis-aligned ray is its own box.
bool is_inside(const Point<3>& p, const TriangleTree& mesh) {
  const Box& box = mesh.tree().box();
  if (mesh.triangles().empty() || !box.contains(p)) return false;
  Eigen::Index up = 0, down = 0;
  const double above = (box.max() - p).minCoeff(&up), below = (p - box.min()).minCoeff(&down);
  Point<3> outside = p;
  if (below < above)
    outside[down] = box.min()[down] - box.diagonal().norm();
  else
    outside[up] = box.max()[up] + box.diagonal().norm();
  return signed_crossings(p, outside, mesh) > 0;
}

SweptMesh::SweptMesh(const TriangleMeshView& from, const TriangleMeshView& to, std::span<const std::uint32_t> welded) {
  std::vector<Box> boxes;
  for (const auto& triangle : from.triangles) {
    std::array<std::uint32_t, 3> corner = triangle;
    Prism prism{{}, {}, 1};
    const auto order = [&](int a, int b) {
      if (welded[corner[a]] <= welded[corner[b]]) return;
      std::swap(corner[a], corner[b]);
      prism.orientation = -prism.orientation;
    };
    order(0, 1);
    order(1, 2);
    order(0, 1);
    Box box;
    for (int i = 0; i < 3; ++i) {
      prism.from[i] = from.vertex(corner[i]);
      prism.to[i] = to.vertex(corner[i]);
      box.extend(prism.from[i]).extend(prism.to[i]);
    }
    prisms_.push_back(prism);
    boxes.push_back(box);
  }
  tree_ = BoxTree(std::move(boxes));
}

int SweptMesh::signed_crossings(const Point<3>& p, const Point<3>& q) const {
  int sum = 0;
  const Point<4> start = at_time(p, 0), end = at_time(q, 1);
  tree_.for_each_overlapping(Box(p).extend(q), [&](int item) {
    const Prism& prism = prisms_[item];
    if (separated_by_coordinate(p, q, prism.from, prism.to)) return;
    std::array<Point<4>, 3> v, w;
    for (int i = 0; i < 3; ++i) {
      v[i] = at_time(prism.from[i], 0);
      w[i] = at_time(prism.to[i], 1);
    }
    // For a static triangle det(v1 - v0, v2 - v0, w2 - v0, x - v0) = -n.(x - v0); the other two have the signs + and -.
    sum -= prism.orientation * crossing<4>(start, end, {v[0], v[1], v[2], w[2]});
    sum += prism.orientation * crossing<4>(start, end, {v[0], v[1], w[1], w[2]});
    sum -= prism.orientation * crossing<4>(start, end, {v[0], w[0], w[1], w[2]});
  });
  return sum;
}

std::vector<int> proven_crossings(std::span<const double> from, std::span<const double> to,
                                  const TriangleMeshView& mesh, const TriangleTree& tree, std::span<const Link> links) {
  std::vector<int> step(from.size() / 3);
  for (std::size_t i = 0; i < step.size(); ++i) step[i] = signed_crossings(point_at(from, i), point_at(to, i), tree);
  const auto differ = [&](const Link& l) { return step[l[0]] != step[l[1]]; };
  const auto crosses_at = [&](std::span<const double> x) {
    return std::any_of(links.begin(), links.end(),
                       [&](const Link& l) { return crosses(point_at(x, l[0]), point_at(x, l[1]), tree); });
  };
  if (std::none_of(links.begin(), links.end(), differ) || crosses_at(from) || crosses_at(to)) return step;

  // A vertex has not moved around the border if its distances to the border (start plus end) exceed twice its path.
  const std::vector<Link> border = border_of(mesh);
  const auto distance = [&](const Point<3>& point) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : border)
      least = std::min(least, squared_distance(point, point, mesh.vertex(a), mesh.vertex(b)));
    return std::sqrt(least);
  };
  std::vector<bool> proven(step.size(), false);
  for (std::size_t i = 0; i < step.size(); ++i) {
    const Point<3> p = point_at(from, i), q = point_at(to, i);
    proven[i] = step[i] != 0 && distance(p) + distance(q) > 2 * (q - p).norm();
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : links)
      if (step[a] == step[b] && step[a] != 0 && proven[a] != proven[b]) proven[a] = proven[b] = changed = true;
  }
  // Drop the crossings of every unproven group that has a link to others, from the linked vertices inwards.
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : links) {
      if (step[a] == step[b]) continue;
      for (const std::uint32_t i : {a, b})
        if (!proven[i] && step[i] != 0) step[i] = 0, changed = true;
    }
  }
  return step;
}

}  // namespace clothbench::contact
