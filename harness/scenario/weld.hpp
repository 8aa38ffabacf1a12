#pragma once
#include <cstddef>

#include "assets/mesh_file.hpp"

namespace clothbench {

/// Replaces every vertex within `distance_m` [m] of an earlier one by that one; 0: those in the same place. The others
/// keep their order. Texture coordinates belong to triangles and stay. Returns the number of vertices removed.
std::size_t weld(assets::MeshFile&, double distance_m);

}  // namespace clothbench
