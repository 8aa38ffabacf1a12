#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "clothbench/solver.hpp"

namespace clothbench {

/// Facts that a reader needs to judge a number: machine, compiler, commit, date, device. Stored with every run.
nlohmann::json describe_environment(const DeviceInfo& device, const std::string& protocol);

/// The features that a solver declares, for the feature table: names of features under "supports" and "ignores", and
/// under "only_with" pairs of a feature and another that it requires.
nlohmann::json describe_features(const SolverInfo& info);

/// Adds to an environment the solver's version and features, and of a plugin its library: path, SHA-256 of the file,
/// summary. Two builds of a plugin differ by the hash.
void describe_solver(const SolverInfo&, nlohmann::json& environment);

/// UTC, ISO 8601, seconds.
std::string utc_now();

}  // namespace clothbench
