#include "metrics/contact/half_space.hpp"

#include <algorithm>
#include <limits>

namespace clothbench::contact {

ContactSample half_space_contact(const TriangleMeshView& cloth, const Point<3>& on_plane, const Point<3>& normal) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  if (!all_finite(cloth.positions)) return {kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};
  Depth depth;
  Contour contour;
  double cloth_area = 0, behind = 0;
  std::vector<Piece> pieces;
  const auto depth_of = [&](const Point<3>& p) { return normal.dot(on_plane - p); };
  for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
    const Simplex<3> v = cloth.triangle(t);
    const std::array<double, 3> f{depth_of(v[0]), depth_of(v[1]), depth_of(v[2])};
    for (const double d : f) {
      depth.max_m = std::max(depth.max_m, d);
      if (d > 0) behind += area(v) / 3;
    }
    cloth_area += area(v);
    const double length = clip_to_inside(v, f, pieces);
    contour.length_m += length;
    if (length > 0) ++contour.pairs;
  }
  depth.vertex_max_m = depth.max_m;
  summarize(pieces, cloth_area, depth);
  const auto pairs = static_cast<double>(contour.pairs);
  return {contour.length_m,
          pairs,
          pairs / static_cast<double>(cloth.triangles.size()),
          behind / cloth_area,
          depth.max_m,
          depth.max_m,
          depth.vertex_max_m,
          depth.p99_m,
          depth.mean_m,
          depth.area_m2,
          depth.area_fraction};
}

}  // namespace clothbench::contact
