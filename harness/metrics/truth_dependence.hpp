#pragma once
#include <map>
#include <string>

#include "clothbench/scene.hpp"

namespace clothbench {

/// How much a scene's truth depends on its stiffnesses: `truth_dependence_Y` and `truth_dependence_B`. Each is the
/// change of what ranks the scene's runs (quantity or positions, truth::ReferenceCase) with the logarithm of the
/// membrane stiffness or the bending rigidity, from evaluating the reference case at 10 % more of each. 1 means that it
/// changes by 1 % for 1 % more stiffness; 0 that the scene has no such stiffness. For truths in motion it is the
/// greatest of a few frames. Empty for a scene without a reference case.
std::map<std::string, double> truth_dependence(const Scene&);

}  // namespace clothbench
