#pragma once
#include <filesystem>

#include "runner/solver_run.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {

/// A scene from beginning to end, untimed: positions, metrics, summary and the result of the scene's expectations.
/// Stored in `out` unless that is empty. A pass that takes more than `limit_s` of wall time is `timed_out`; 0 = no
/// limit. `by`: a reference case other than the scene's own, whose quantity at the end is `truth_quantity`. Throws
/// Error as SolverRun does.
RunRecord whole_run(const RunSpec&, const DeviceOptions&, const std::string& protocol, const std::filesystem::path& out,
                    double limit_s = 0, const truth::ReferenceCase* by = nullptr);

/// The same run reduced to its end, for a search that stores nothing: no metric is evaluated, and the summary has only
/// `truth_quantity`, for a scene with a truth. Throws Error if the solver cannot be loaded.
RunRecord end_of_run(const RunSpec&, const DeviceOptions&, const std::string& protocol,
                     const truth::ReferenceCase* by = nullptr);

/// The header fields that identify a run, without the machine.
RunHeader bare_header(const RunSpec&, const std::string& protocol);

}  // namespace clothbench
