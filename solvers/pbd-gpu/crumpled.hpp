#pragma once
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::pbd_gpu {

/// Does the cloth start with a structural link shorter than half or longer than one and a half times its rest length:
/// crumpled, squashed, coincident, pulled out of shape? Nothing physical starts so; what matters is that it recovers.
bool starts_crumpled(const Scene&);

/// Moves every free vertex of a crumpled start by less than a thousandth of a cell, the same way in every run: vertices
/// at one point have no direction to be pushed apart in, and a cloth squashed into a plane cannot unfold within it. `x`
/// [m], xyz.
void break_symmetry(const Scene&, const std::vector<float>& inverse_mass, std::vector<double>& x);

}  // namespace clothbench::pbd_gpu
