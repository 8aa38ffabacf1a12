#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "clothbench/vector.hpp"

namespace clothbench {

/// Most corners of a polygon.
inline constexpr std::size_t kMostCorners = 1000;

/// Cuts a polygon, convex or not, into triangles inside it, wound as it is (ear clipping: Meisters 1975). The polygon
/// need not be flat: it is cut as seen along the axis nearest to its normal. `corners` [m]; the triangles hold indices
/// of corners. A corner at the position of the corner before it is in no triangle. Throws Error "<where>: ..." for a
/// polygon that has no area, crosses or touches itself, is too thin to be cut, or has over `kMostCorners` corners.
std::vector<std::array<std::uint32_t, 3>> triangulated(const std::vector<Vec3>& corners, const std::string& where);

}  // namespace clothbench
