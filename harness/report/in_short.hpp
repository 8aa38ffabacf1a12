#pragma once
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// One row a run, by scene, the fastest first: how it ended, its stretch, its frame time, and the ratio to the fastest
/// frame time. Runs that failed, or whose cloth is stretched to more than twice its length, follow without a rank; runs
/// without trials come last.
Table in_short_table(const std::vector<RunRecord>& runs);

}  // namespace clothbench
