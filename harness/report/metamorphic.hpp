#pragma once
#include <nlohmann/json.hpp>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// Whether a run is one of `clothbench metamorphic`: a change of a scene whose effect is known without a truth.
bool is_metamorphic(const RunRecord&);

/// One table for each solver and setting. Rows are properties, columns scenes.
std::vector<Table> metamorphic_tables(const std::vector<RunRecord>&);

/// [{solver, property, scene, status, distance, bitwise, at_most}]; status: "pass", "fail", "unsupported", "failed" or
/// "crashed: " and how. The distance is relative to the longer side; null if it is not known.
nlohmann::json metamorphic_json(const std::vector<RunRecord>&);

}  // namespace clothbench
