#pragma once
#include <string>

#include "check/compare.hpp"

namespace clothbench {

/// Workflow commands of GitHub Actions: one `::error` per failed run, one `::notice` for all improvements and one for
/// all new runs (GitHub shows ten of a kind per step). `file`: the baseline, to which the annotations point.
std::string github_commands(const Checked&, const std::string& file);

}  // namespace clothbench
