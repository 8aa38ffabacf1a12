#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runner/solver_choice.hpp"
#include "runner/stability_study.hpp"

namespace clothbench {

/// Where and how a command executes a study.
struct StudyCall {
  std::filesystem::path out;  ///< empty: results/runs/<study>-<UTC>
  bool resume = false;
  bool part = false;  ///< only some of the manifest's runs: no figures of the folder at the end
  DeviceChoice device;
  std::string command_line;                                           ///< stored with the study
  std::vector<std::string> words;                                     ///< the same, for children of the command
  decltype(RunOptions::progress) progress;                            ///< before each task
  std::function<void(const std::string&)> tell = [](const auto&) {};  ///< receives lines for the user, before runs
};

/// An executed study. Its folder has one file a run and study.json.
struct StudyEnd {
  std::filesystem::path out;
  ExitCode exit_code = ExitCode::Ok;
  bool told = false;                ///< a child of this command has printed the results
  std::vector<std::string> faults;  ///< runs that broke a rule of the harness
  /// The summary, made when it is asked for, since both forms may read the folder again. Text: follows the tables.
  std::function<nlohmann::json()> json;
  std::function<std::string()> text;
};

/// results/runs/<study>-<UTC>, and a number where two began in the same second.
std::filesystem::path default_folder(const std::string& study);

/// Executes a plan with timed trials. A plan with a plugin runs in a child of this command.
StudyEnd execute_study(RunPlan, StudyManifest, const StudyCall&);

/// A study of protocol contact or stability-map, whose runs are untimed and in processes of their own, `jobs` at a
/// time.
StudyEnd execute_apart(Study, StudyManifest, const StudyCall&, int jobs);

}  // namespace clothbench
