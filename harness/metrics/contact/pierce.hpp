#pragma once
#include <span>

#include "metrics/contact/wrong_side.hpp"

namespace clothbench::contact {

/// Number of segments that cross a triangle of the cloth; exact (predicates.hpp). Depends on the instant alone. The
/// cloth must be finite. A segment without length crosses nothing.
std::size_t pierced(const TriangleMeshView& cloth, std::span<const Bone> segments);

}  // namespace clothbench::contact
