#pragma once
#include <Eigen/Core>
#include <array>

namespace clothbench::contact {

template <int N>
using Point = Eigen::Matrix<double, N, 1>;

/// N points of N-space: a triangle for N = 3, a tetrahedron of space-time (x, y, z, t) for N = 4.
template <int N>
using Simplex = std::array<Point<N>, N>;

/// Exact sign (-1, 0, 1) of det(head[0] - tail[0], ..., head[N-1] - tail[N-1]), differences not rounded. N = 2, 3, 4.
/// Uses floating point with an error bound first (after Shewchuk 1997), and exact arithmetic where that cannot decide.
template <int N>
int sign_of_determinant(const std::array<Point<N>, N>& head, const std::array<Point<N>, N>& tail);

/// Whether and in which direction the segment p -> q crosses the simplex: +1 along its normal, -1 against it, 0 if not.
///
/// Exact, also in degenerate configurations of p, q and the simplex: there the result is that for the segment
/// translated by shift * (e, e^2, e^3) in space, e -> 0+ (simulation of simplicity, Edelsbrunner & Muecke 1990,
/// restricted to one common translation). A single translation for all tests is consistent: a path through the common
/// edge or vertex of triangles crosses exactly those that it crosses after a small translation, and a path that ends on
/// a surface is on a definite side of it. A simplex without volume is never crossed. The normal of a triangle (a, b, c)
/// is (b - a) x (c - a).
template <int N>
int crossing(const Point<N>& p, const Point<N>& q, const Simplex<N>& simplex, int shift = 1);

/// Whether the area is exactly zero.
bool is_degenerate(const Simplex<3>& triangle);

}  // namespace clothbench::contact
