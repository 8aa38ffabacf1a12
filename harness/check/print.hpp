#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "check/compare.hpp"

namespace clothbench {

/// Failures, improvements and new runs as a table, what values alone do not tell below it, and the verdict in a line.
std::string check_text(const Checked&, const std::string& baseline_file);
nlohmann::json check_json(const Checked&, const std::string& baseline_file);

/// What --update changed, run by run, and in a line.
std::string update_text(const Updated&, const std::string& baseline_file);
nlohmann::json update_json(const Updated&, const std::string& baseline_file);

}  // namespace clothbench
