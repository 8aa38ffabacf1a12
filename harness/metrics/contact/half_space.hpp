#pragma once
#include "metrics/contact/contact_probe.hpp"

namespace clothbench::contact {

/// Contact of a cloth with the half-space behind a plane, on the far side of its unit normal. Exact: on a flat triangle
/// the depth is linear, so clipping at depth 0 gives contour, area and mean without error, and no point is deeper than
/// the deepest vertex. A pair is a triangle that the plane cuts. The tunnelled vertices are those behind the plane. All
/// NaN if the cloth isn't finite.
ContactSample half_space_contact(const TriangleMeshView& cloth, const Point<3>& on_plane, const Point<3>& normal);

}  // namespace clothbench::contact
