#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "clothbench/solver.hpp"

namespace clothbench {

/// What a reader needs to judge a number: machine, compiler, commit, date, device. Stored with every run.
nlohmann::json describe_environment(const DeviceInfo& device, const std::string& protocol);

/// What a solver says it can do, for the feature table: names of features by "supports" and "ignores", and "only_with",
/// pairs of a feature and the one it needs beside it.
nlohmann::json describe_features(const SolverInfo& info);

/// UTC, ISO 8601, seconds.
std::string utc_now();

}  // namespace clothbench
