#pragma once
#include <memory>
#include <nlohmann/json.hpp>

#include "clothbench/solver.hpp"
#include "clothbench_plugin.h"

namespace clothbench::plugin {

/// Values of the settings for the C interface, in the plugin's order.
std::vector<double> setting_values(const ClothbenchPlugin&, const nlohmann::json& settings);

FeatureSet features_of(std::uint32_t bits);

/// One solver of a plugin whose description was checked.
std::unique_ptr<ClothSolver> make_solver(const ClothbenchPlugin&, const SolverInfo&, const nlohmann::json& settings);

}  // namespace clothbench::plugin
