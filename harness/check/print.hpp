#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "check/compare.hpp"

namespace clothbench {

/// A table of failures, improvements and new runs, the explanations below it, and the verdict in one line.
std::string check_text(const Checked&, const std::string& baseline_file);
nlohmann::json check_json(const Checked&, const std::string& baseline_file);

/// The changes that --update made: for each run, and a summary in one line.
std::string update_text(const Updated&, const std::string& baseline_file);
nlohmann::json update_json(const Updated&, const std::string& baseline_file);

}  // namespace clothbench
