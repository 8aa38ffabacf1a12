#pragma once
#include <string>

#include "check/compare.hpp"

namespace clothbench {

/// Workflow commands of GitHub Actions: one `::error` a failed run, one `::notice` for all that improved and one for
/// all that is new (GitHub shows ten of a kind a step). `file`: what the annotations point to, the baseline.
std::string github_commands(const Checked&, const std::string& file);

}  // namespace clothbench
