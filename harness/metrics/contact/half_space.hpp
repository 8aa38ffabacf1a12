#pragma once
#include "metrics/contact/contact_probe.hpp"

namespace clothbench::contact {

/// Contact of a cloth with the half-space behind a plane, opposite to its unit normal. Exact: depth is linear on a flat
/// triangle, so clipping at depth 0 gives contour, area and mean without error, and the deepest point is a vertex. A
/// pair is a triangle that the plane cuts. The tunnelled vertices are those behind the plane. All values are NaN if the
/// cloth is not finite.
ContactSample half_space_contact(const TriangleMeshView& cloth, const Point<3>& on_plane, const Point<3>& normal);

}  // namespace clothbench::contact
