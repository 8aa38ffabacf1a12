#pragma once
#include <functional>

#include "runner/threshold.hpp"

namespace clothbench {

/// The runs that the closed forms of friction (metrics/friction_forms.hpp) ask of a solver, with the overrides `set` in
/// every scene, a plugin's in a child. What it does not support is one run `unsupported`. `note` is called for each
/// form before it is asked.
std::vector<RunRecord> friction_runs(Guard&, StudyRuns&, const SolverEntry&, const nlohmann::json& settings,
                                     const std::string& setting, const std::vector<std::string>& set,
                                     const std::function<void(const std::string& scene)>& note);

}  // namespace clothbench
