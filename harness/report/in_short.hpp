#pragma once
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// One row a run, by scene and the fastest first: how it ended, the time of a frame and how many times that of the
/// fastest. Runs without trials come last.
Table in_short_table(const std::vector<RunRecord>& runs);

}  // namespace clothbench
