#pragma once
#include "clothbench/scene.hpp"
#include "metrics/friction_forms.hpp"
#include "runner/study_runs.hpp"

namespace clothbench {

/// Runs search_threshold with a run of the whole scene for each coefficient (`setting`: short name of `settings`). The
/// runs are appended to `tried` if it is given. Throws Error if the scene's reference case has no threshold (see
/// truth/reference_case.hpp) or the solver cannot run the scene.
FoundThreshold find_threshold(const Scene&, const SolverEntry&, const nlohmann::json& settings, StudyRuns&,
                              const std::string& setting = "default", std::vector<RunRecord>* tried = nullptr);
/// The same without storing any run.
FoundThreshold find_threshold(const Scene&, const SolverEntry&, const nlohmann::json& settings, const DeviceOptions&);

/// The runs of find_threshold, in a child for a plugin; if the child crashes or the solver cannot run the scene, one
/// record of the scene itself.
std::vector<RunRecord> threshold_runs(Guard&, StudyRuns&, const Scene&, const SolverEntry&,
                                      const nlohmann::json& settings, const std::string& setting);

}  // namespace clothbench
