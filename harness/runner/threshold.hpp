#pragma once
#include "clothbench/scene.hpp"
#include "metrics/friction_forms.hpp"
#include "runner/study_runs.hpp"

namespace clothbench {

/// The search of search_threshold, each try a run of the whole scene (`setting`: short name of `settings`). With
/// `tried` the runs are added to it. Throws Error if the scene's known has no threshold (see truth/reference_case.hpp)
/// or the solver cannot run it.
FoundThreshold find_threshold(const Scene&, const SolverEntry&, const nlohmann::json& settings, StudyRuns&,
                              const std::string& setting = "default", std::vector<RunRecord>* tried = nullptr);
/// ... of which nothing is stored.
FoundThreshold find_threshold(const Scene&, const SolverEntry&, const nlohmann::json& settings, const DeviceOptions&);

/// The runs of find_threshold, a plugin's in a child; a crash of that is one record, of the scene itself.
std::vector<RunRecord> threshold_runs(Guard&, StudyRuns&, const Scene&, const SolverEntry&,
                                      const nlohmann::json& settings, const std::string& setting);

}  // namespace clothbench
