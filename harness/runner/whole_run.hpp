#pragma once
#include <filesystem>

#include "runner/solver_run.hpp"

namespace clothbench {

/// Rules of one untimed run.
struct RunRules {
  DeviceOptions device = {};
  std::string protocol = {};
  std::filesystem::path out = {};  ///< folder for the result file; empty: none is written
  double limit_s = 0;              ///< a pass that takes more wall time is `timed_out`; 0 = no limit
};

/// A scene from beginning to end, untimed: positions, metrics, summary and the result of the scene's expectations.
/// Throws Error as SolverRun does.
RunRecord whole_run(const RunSpec&, const RunRules&);

}  // namespace clothbench
