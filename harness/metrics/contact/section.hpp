#pragma once
#include <span>
#include <vector>

#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {

/// All points within `radius_m` of the segment a-b; a sphere if a = b.
struct Capsule {
  Point<3> a, b;
  double radius_m;
};

inline Capsule sphere(const Point<3>& centre, double radius_m) { return {centre, centre, radius_m}; }

/// Signed distance [m] to the surface, negative inside; exact.
double signed_distance(const Point<3>& p, const Capsule&);

/// The part of a triangle that lies inside a union of capsules, bounded by arcs of circles and ellipses and by parts of
/// the triangle's edges. Area and border are in closed form between the ends of the arcs, which are found to 1e-8 m and
/// interpolated from there: the results are correct to 1e-9 m and 1e-9 m².
class TriangleSection {
 public:
  /// The triangle's corners [m] are finite. A triangle without area has no section, and a depth all the same.
  TriangleSection(const Simplex<3>& triangle, std::span<const Capsule> shapes);

  /// Greatest depth [m] of a point of the triangle in any single capsule; 0 where it is in none.
  double depth_m() const { return depth_m_; }
  /// Area [m²] of what is deeper than `depth_m`: that inside of the same capsules with radii less by so much.
  double area_deeper_m2(double depth_m) const;
  struct Border {
    double length_m = 0;          ///< of the line in which triangle and surface cross
    std::ptrdiff_t capsules = 0;  ///< whose surface has a part of it
  };
  Border border() const;

 private:
  /// A ball (length 0) or the inside of a round side with flat ends; a capsule is two balls and a side.
  struct Part {
    Point<3> at, end, along;
    double length_m, radius_m;
    std::size_t capsule;
  };
  /// centre + cos(t) u + sin(t) v for t from `from` to `to`; u and v are at right angles.
  struct Arc {
    Point<3> centre, u, v;
    double from, to;
  };
  struct Range {
    double from, to;
  };

  void add(const Capsule&, std::size_t index);
  std::vector<Part> deeper_than(double depth_m) const;
  std::vector<Arc> arcs(const Part&) const;
  std::vector<Arc> side_arcs(const Part&) const;
  std::vector<Range> kept(const Arc&, std::span<const Part>, std::size_t own) const;
  static double outside(const Point<3>&, const Part&, const Part& own);
  double edges_twice_area(std::span<const Part>) const;
  std::vector<Range> inside_of_edge(int edge, std::span<const Part>) const;
  double twice_area(const Point<3>& from, const Point<3>& to) const;

  Simplex<3> corners_;
  Point<3> normal_, x_, y_;
  std::array<Point<3>, 3> inward_;
  bool flat_ = false;  ///< has no area
  double depth_m_ = 0;
  std::vector<Part> parts_;
  std::vector<double> reach_m_;  ///< one a part: the greatest depth in its capsule
};

}  // namespace clothbench::contact
