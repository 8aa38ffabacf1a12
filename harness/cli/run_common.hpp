#pragma once
#include "cli/command.hpp"
#include "runner/study_runner.hpp"

namespace clothbench {

struct RunFlags {
  std::string out;  ///< empty: results/runs/<study>-<UTC>
  bool resume = false;
  DeviceFlags device;
};

/// Writes the manifest, runs the cells with a status line and prints what came of it. Sets the console's exit code to
/// CheckFailed if a cell broke a rule of the harness.
void run_and_tell(CellPlan plan, StudyManifest manifest, const RunFlags& flags, Console& console);

}  // namespace clothbench
