#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "clothbench/solver.hpp"

namespace clothbench {

/// What a reader needs to judge a number: machine, compiler, commit, date, device. Stored with every cell.
nlohmann::json describe_environment(const DeviceInfo& device, const std::string& protocol);

/// UTC, ISO 8601, seconds.
std::string utc_now();

}  // namespace clothbench
