#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace clothbench {

/// What a solver is in comparisons, from the data file solvers.json, since stored results of before do not say it.

/// The whole file: roles, and colours of figures by label.
const nlohmann::json& solver_roles();

/// The harness without a cloth model: its times are what the harness costs, and its motion proves nothing.
bool is_floor(const std::string& solver);

/// The model itself, to which others are compared; it is not ranked.
bool is_baseline(const std::string& solver);

}  // namespace clothbench
