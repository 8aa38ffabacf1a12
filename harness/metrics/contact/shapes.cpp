#include "metrics/contact/shapes.hpp"

#include <algorithm>
#include <array>

namespace clothbench::contact {
namespace {

/// Gauss and Legendre's rule on [0, 1], the half above the middle (Abramowitz & Stegun, table 25.4).
struct Node {
  double from_middle, weight;
};
constexpr std::array<Node, kDepthNodes / 2> kNodes{{{0.5 * 0.1834346424956498, 0.5 * 0.3626837833783620},
                                                    {0.5 * 0.5255324099163290, 0.5 * 0.3137066458778873},
                                                    {0.5 * 0.7966664774136267, 0.5 * 0.2223810344533745},
                                                    {0.5 * 0.9602898564975363, 0.5 * 0.1012285362903763}}};

/// Integral of the area that is deeper than d, over d: area times mean depth.
double moment_m3(const TriangleSection& section) {
  double sum = 0;
  for (const Node& n : kNodes)
    for (const double at : {0.5 - n.from_middle, 0.5 + n.from_middle})
      sum += n.weight * section.area_deeper_m2(at * section.depth_m());
  return sum * section.depth_m();
}

/// The depth that `area_m2` of the sections lies below, by halving: the area falls with the depth.
double depth_with_area_below(const std::vector<TriangleSection>& sections, double area_m2, double greatest_m) {
  double low = 0, high = greatest_m;
  while (high - low > 1e-10) {
    const double middle = 0.5 * (low + high);
    double below = 0;
    for (const TriangleSection& s : sections)
      if (s.depth_m() > middle && !(below > area_m2)) below += s.area_deeper_m2(middle);
    (below > area_m2 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void set_depth(const std::vector<TriangleSection>& sections, double cloth_area_m2, Depth& depth) {
  double moment = 0;
  for (const TriangleSection& s : sections) {
    depth.max_m = std::max(depth.max_m, s.depth_m());
    const double area = s.area_deeper_m2(0);
    if (!(area > 0)) continue;
    depth.area_m2 += area;
    moment += moment_m3(s);
  }
  if (!(depth.area_m2 > 0)) return;
  depth.mean_m = moment / depth.area_m2;
  depth.area_fraction = depth.area_m2 / cloth_area_m2;
  depth.p99_m = depth_with_area_below(sections, 0.01 * depth.area_m2, depth.max_m);
}

}  // namespace

ShapesResult shapes_contact(const TriangleMeshView& cloth, std::span<const Capsule> shapes) {
  ShapesResult result;
  std::vector<TriangleSection> sections;
  double cloth_area_m2 = 0;
  for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
    const Simplex<3> triangle = cloth.triangle(t);
    cloth_area_m2 += area(triangle);
    const TriangleSection section(triangle, shapes);
    if (!(section.depth_m() > 0)) continue;
    const TriangleSection::Border border = section.border();
    result.contour.length_m += border.length_m;
    result.contour.pairs += static_cast<std::size_t>(border.capsules);
    if (border.capsules > 0) ++result.contour.cloth_triangles;
    sections.push_back(section);
  }
  set_depth(sections, cloth_area_m2, result.depth);
  for (std::size_t i = 0; i < cloth.vertex_count(); ++i) {
    double depth = 0;
    for (const Capsule& c : shapes) depth = std::max(depth, -signed_distance(cloth.vertex(i), c));
    result.inside.push_back(depth > 0);
    result.depth.vertex_max_m = std::max(result.depth.vertex_max_m, depth);
  }
  return result;
}

}  // namespace clothbench::contact
