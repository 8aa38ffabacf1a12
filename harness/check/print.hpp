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

/// Times and results of two builds: tables, and the JSON of both.
std::string comparison_text(const Checked&);
nlohmann::json comparison_json(const Checked&);

/// JUnit XML as CI servers read it: one test case per run (class = scene, name = solver and setting), with a
/// <failure> if it failed. Improvements and new runs are in <system-out>. Text that XML 1.0 or UTF-8 does not allow is
/// replaced.
std::string junit_xml(const Checked&);

/// A command of GitHub Actions per failure, which shows it at the top of the job.
std::string github_annotations(const Checked&);

}  // namespace clothbench
