#pragma once
#include <nlohmann/json.hpp>
#include <vector>

#include "report/leak.hpp"

namespace clothbench {

/// Rows: solvers (of each pulled strip); columns: speeds of the bars; entries: greatest strain against its exact wave,
/// the most of all frames over v0/c, and RMS distance over space and time over L; before them, the first speed at which
/// `leak_of` finds a fault. No rows but the header without a set-up of kind "wave". Source of the answer: reference
/// case two-hand-pull.
Table pulled_strip_table(const std::vector<ContactSetUp>&);

nlohmann::json pulled_strip_json(const std::vector<ContactSetUp>&);

}  // namespace clothbench
