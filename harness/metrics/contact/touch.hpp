#pragma once
#include "metrics/contact/capsules.hpp"
#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {

/// Squared distance [m2] between the segments a-b and c-d (Ericson, Real-Time Collision Detection, 5.1.9).
double squared_distance(const Point<3>& a, const Point<3>& b, const Point<3>& c, const Point<3>& d);

/// Squared distance [m2] between the segment a-b and a triangle: 0 if they cross.
double squared_distance(const Point<3>& a, const Point<3>& b, const Simplex<3>& triangle);

/// Whether a triangle has a point at most `reach_m` from the surface of a capsule, or inside the capsule.
bool within(const Simplex<3>& triangle, const Capsule&, double reach_m);

/// Whether two triangles have points at most `reach_m` apart.
bool within(const Simplex<3>& triangle, const Simplex<3>& other, double reach_m);

}  // namespace clothbench::contact
