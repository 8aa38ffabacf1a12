#include "metrics/contact/contour.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>

namespace clothbench::contact {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Triangle_3 to_cgal(const Simplex<3>& v) {
  const auto point = [](const Point<3>& p) { return Kernel::Point_3(p[0], p[1], p[2]); };
  return {point(v[0]), point(v[1]), point(v[2])};
}

/// Point where the segment meets the plane of the triangle, known to lie between p and q.
Point<3> point_of_crossing(const Point<3>& p, const Point<3>& q, const Simplex<3>& v) {
  const Point<3> normal = (v[1] - v[0]).cross(v[2] - v[0]);
  const double height_p = std::abs(normal.dot(p - v[0])), height_q = std::abs(normal.dot(q - v[0]));
  // If the sum of the heights is rounding noise, so are both heights; then any point between will do.
  const double share = height_p + height_q > 0 ? height_p / (height_p + height_q) : 0.5;
  return p + share * (q - p);
}

void add_pair(Contour& to, const Simplex<3>& cloth, const Simplex<3>& object) {
  if (!CGAL::do_intersect(to_cgal(cloth), to_cgal(object))) return;
  ++to.pairs;
  if (const auto cut = intersection(cloth, object)) to.length_m += ((*cut)[1] - (*cut)[0]).norm();
}

}  // namespace

// Each end of the segment is a crossing of an edge of one triangle with the other.
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

}  // namespace clothbench::contact
