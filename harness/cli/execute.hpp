#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runner/solver_choice.hpp"
#include "runner/study_runner.hpp"

namespace clothbench {

/// Where and how a command executes a study.
struct StudyCall {
  std::filesystem::path out;  ///< empty: results/runs/<study>-<UTC>
  bool resume = false;
  int jobs = 1;
  std::string eye = {};  ///< size of the pictures that the plan renders
  bool drawn = false;    ///< runs of generated contact scenes, which the summary counts by their verdicts
  bool part = false;     ///< only some of the manifest's runs: no figures of the folder at the end
  DeviceChoice device;
  std::string command_line;                 ///< stored with the study
  decltype(RunOptions::progress) progress;  ///< before each task
  std::function<void()> before_runs = {};   ///< once the folder is known to be usable
};

/// An executed study. Its folder has one file a run and study.json.
struct StudyEnd {
  std::filesystem::path out;
  ExitCode exit_code = ExitCode::Ok;
  std::vector<std::string> faults;  ///< runs that broke a rule of the harness
  /// The summary, made when it is asked for, since both forms may read the folder again. Text: follows the tables.
  std::function<nlohmann::json()> json;
  std::function<std::string()> text;
};

/// results/runs/<study>-<UTC>, and a number where two began in the same second.
std::filesystem::path default_folder(const std::string& study);

/// Executes a plan and makes its folder. A timed plan with a plugin runs in a worker process.
StudyEnd execute_study(RunPlan, StudyManifest, const StudyCall&);

}  // namespace clothbench
