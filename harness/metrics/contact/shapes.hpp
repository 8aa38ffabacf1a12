#pragma once
#include <span>

#include "metrics/contact/contour.hpp"
#include "metrics/contact/depth.hpp"
#include "metrics/contact/section.hpp"

namespace clothbench::contact {

struct ShapesResult {
  Contour contour;  ///< pairs: (cloth triangle, capsule) that contain part of the contour
  Depth depth;      ///< in the union: the depth of a point is that in the single capsule in which it is deepest
  std::vector<bool> inside;  ///< one per vertex
};

/// Contour and depth of a cloth in a union of capsules, from the plane sections of the capsules (TriangleSection).
///
/// The points deeper than d are those inside of the same capsules with radii less by d. So the mean depth is the
/// integral of that area over d, by Gauss's rule of kDepthNodes points for each triangle, over the area at d = 0; and
/// the 99th percentile is the d at which a hundredth of the area at 0 is left. Contour, greatest depth and area are
/// correct to 1e-9 m and 1e-9 m2, the percentile to 1e-9 m. The mean over one triangle is within 2 %
/// of itself (RMS of drawn triangles: 0.2 %; Section.MeanDepthIsNearItsIntegral), over many far less.
ShapesResult shapes_contact(const TriangleMeshView& cloth, std::span<const Capsule> shapes);
inline constexpr int kDepthNodes = 8;

}  // namespace clothbench::contact
