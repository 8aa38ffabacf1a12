#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "runner/again.hpp"
#include "runner/solver_choice.hpp"

namespace clothbench {

/// What a solver would run for a scene, in a child for a plugin: scene, solver, needs, status, message, stages,
/// buffers, left_out, contact_margins. Without stages if the solver cannot run the scene or its process crashed.
nlohmann::json ask_plan(Guard&, const Scene&, const ChosenSolver&, const DeviceOptions&);

/// The same for the terminal.
std::string plan_text(const nlohmann::json& plan);

}  // namespace clothbench
