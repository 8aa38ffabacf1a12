#pragma once
#include <span>

#include "metrics/contact/surface.hpp"
#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {

/// Contact of a cloth with one object at one instant. Both are NaN if the cloth is not finite.
struct ContactSample {
  double contour_length_m;  ///< of the intersection contour of cloth and object
  double depth_max_m;       ///< of the cloth in the object, also between vertices; NaN for an object without inside
};

/// Contact with a mesh as it is: the contour is exact (contour.hpp), the depth is the largest distance from the surface
/// of all vertices, edge midpoints and centroids that are inside. Vertices only would miss a finger that comes up
/// through the middle of a triangle. A mesh with an inside is closed, with outward normals. `links`: edges_of the
/// cloth.
ContactSample mesh_contact(const TriangleMeshView& cloth, std::span<const Link> links, const TriangleTree& mesh,
                           bool has_inside);

/// Contact with capsules, whose radii are positive. They are triangles for the contour (capsule_mesh), which is at most
/// kCapsuleError of the radius too far inside; segments inside another capsule are left out. The depth is exact: of the
/// deepest point of a triangle in any single capsule.
ContactSample capsule_contact(const TriangleMeshView& cloth, std::span<const Capsule> shapes);

/// Contact of a cloth with the half-space behind a plane, opposite to its unit normal. Exact: depth is linear on a flat
/// triangle, so its contour is one straight cut, and its deepest point is a vertex.
ContactSample half_space_contact(const TriangleMeshView& cloth, const Point<3>& on_plane, const Point<3>& normal);

}  // namespace clothbench::contact
