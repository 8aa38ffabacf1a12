#pragma once
#include <map>
#include <string>

#include "clothbench/scene.hpp"

namespace clothbench {

/// How much a scene's truth depends on its stiffnesses: `truth_dependence_Y` and `truth_dependence_B`, the change of
/// what ranks its runs (truth::ReferenceCase) with the logarithm of the membrane stiffness and of the bending rigidity,
/// found by evaluating the reference case at 10 % more of each. 1: it changes by a hundredth for a hundredth more. 0
/// where the scene has no such stiffness. Moving truths: the greatest of a few frames. Empty for a scene without a
/// reference case.
std::map<std::string, double> truth_dependence(const Scene&);

}  // namespace clothbench
