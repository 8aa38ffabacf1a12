#pragma once
#include <functional>

#include "runner/threshold.hpp"

namespace clothbench {

/// The runs that the closed forms of friction (metrics/friction_forms.hpp) require of a solver, in a child for a
/// plugin, with the overrides `set` in every scene. An unsupported form is one run `unsupported`. `note` is called
/// before each form.
std::vector<RunRecord> friction_runs(Guard&, StudyRuns&, const SolverEntry&, const nlohmann::json& settings,
                                     const std::string& setting, const std::vector<std::string>& set,
                                     const std::function<void(const std::string& scene)>& note);

}  // namespace clothbench
