#pragma once
#include <nlohmann/json.hpp>
#include <vector>

#include "report/leak.hpp"

namespace clothbench {

/// Rows: solvers, for each pulled strip. First column: the lowest speed at which `leak_of` finds a fault. Then a column
/// for each speed of the bars: error of the greatest strain against the exact wave (maximum over frames, over v0/c),
/// and RMS distance over space and time, over L. Only the header without a set-up of kind "wave". The exact solution is
/// reference case two-hand-pull.
Table pulled_strip_table(const std::vector<ContactSetUp>&);

nlohmann::json pulled_strip_json(const std::vector<ContactSetUp>&);

}  // namespace clothbench
