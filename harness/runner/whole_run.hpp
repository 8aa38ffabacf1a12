#pragma once
#include <filesystem>

#include "runner/solver_run.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {

/// Rules of one untimed run.
struct RunRules {
  DeviceOptions device = {};
  std::string protocol = {};
  std::filesystem::path out = {};  ///< folder for the result file; empty: none is written
  double limit_s = 0;              ///< a pass that takes more wall time is `timed_out`; 0 = no limit
  /// A reference case other than the scene's own, whose quantity at the end is `truth_quantity`; null: none.
  const truth::ReferenceCase* by = nullptr;
};

/// A scene from beginning to end, untimed: positions, metrics, summary and the result of the scene's expectations.
/// Throws Error as SolverRun does.
RunRecord whole_run(const RunSpec&, const RunRules&);

/// The same run reduced to its end, for a search that stores nothing: no metric is evaluated, and the summary has only
/// `truth_quantity`, for a scene with a truth. Throws Error if the solver cannot be loaded.
RunRecord end_of_run(const RunSpec&, const RunRules&);

/// The header fields that identify a run, without the machine.
RunHeader bare_header(const RunSpec&, const std::string& protocol);

}  // namespace clothbench
