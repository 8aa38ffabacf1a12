#pragma once

namespace clothbench {
extern const char* const kPublishedTable3;  ///< results/paper-table3.json
extern const char* const kSolverRoles;      ///< solvers.json
}  // namespace clothbench
