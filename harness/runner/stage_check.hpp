#pragma once
#include <string>

#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// "Leave out what a scene does not need", checked: the features its stages serve must be exactly those the scene
/// needs, less those the backend declares to ignore. Returns what is extra or missing, or "" if all is well.
std::string check_stages(const Scene& scene, const SolverInfo& info, const Plan& plan);

}  // namespace clothbench
