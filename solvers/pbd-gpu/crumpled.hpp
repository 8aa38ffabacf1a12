#pragma once
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::pbd_gpu {

/// True if the cloth starts with a structural link shorter than 0.5 or longer than 1.5 times its rest length: crumpled,
/// squashed, coincident, pulled out of shape. No physical cloth starts so; the solver only has to recover from it.
bool starts_crumpled(const Scene&);

/// Moves every free vertex of a crumpled start by less than a thousandth of a cell a coordinate, the same in every run.
/// Coincident vertices have no direction to separate in, and a cloth squashed into a plane cannot unfold within it. `x`
/// [m], xyz.
void break_symmetry(const Scene&, const std::vector<float>& inverse_mass, std::vector<double>& x);

}  // namespace clothbench::pbd_gpu
