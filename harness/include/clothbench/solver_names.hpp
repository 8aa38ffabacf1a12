#pragma once
#include <string>
#include <vector>

namespace clothbench {

/// Names of the solvers whose sources this tree has, built or not: those that solvers/CMakeLists.txt lists. A study
/// that names one which this build lacks has rows `unsupported`; any other unknown name is a spelling error.
const std::vector<std::string>& solver_names_of_tree();

}  // namespace clothbench
