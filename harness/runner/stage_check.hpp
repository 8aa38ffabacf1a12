#pragma once
#include <string>

#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// Checks that a plan leaves out stages a scene does not need: the features that its stages serve must be exactly those
/// the scene needs, less those the backend declares to ignore. Returns the extra or missing ones, or "" if there are
/// none.
std::string check_stages(const Scene& scene, const SolverInfo& info, const Plan& plan);

}  // namespace clothbench
