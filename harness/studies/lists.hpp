#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace clothbench {

/// What `clothbench list` can list: solvers, features, scenarios, studies, devices, metrics, scalars, assets.
std::vector<std::string> list_names();

/// One object a row. `what` is one of list_names().
nlohmann::json list_of(const std::string& what);

/// The same for the terminal.
std::string list_text(const std::string& what);

}  // namespace clothbench
