#pragma once
#include <string>

#include "runner/run_process.hpp"
#include "runner/study_runner.hpp"

namespace clothbench {

/// Whether some run's solver is a plugin, so that a timed plan needs a process that may crash.
bool needs_process(const RunPlan&);

/// As execute_runs for a timed plan, but in a worker process, where everything is timed as usual. If the process
/// crashes, or a plugin's run makes no progress for plugin_limit_s(), the current run is stored as `crashed` or
/// `timed_out` and a new process continues with the rest. `eye`: size of the pictures that the plan renders, or empty.
RunResult execute_in_process(const RunPlan&, const RunOptions&, const std::string& eye);

/// The worker's side; `rendering_of` makes the plan's rendering from `eye`.
nlohmann::json execute_plan(const nlohmann::json& request, const WorkerProgress&,
                            Rendering (*rendering_of)(const std::string& eye));

}  // namespace clothbench
