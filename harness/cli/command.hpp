#pragma once
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/json_text.hpp"
#include "base/status_line.hpp"
#include "clothbench/error.hpp"
#include "runner/study_plan.hpp"
#include "runner/study_runner.hpp"
#include "scenario/load.hpp"

namespace clothbench {

/// results/runs/<study>-<UTC>, with a number appended if two begin in the same second.
std::filesystem::path default_folder(const std::string& study);

/// State shared by all commands. A command adds itself to the app and runs in its callback; it throws Error on failure.
struct Console {
  bool json = false;  ///< print a machine-readable summary instead of tables
  std::string command_line;
  ExitCode exit_code = ExitCode::Ok;

  /// Storage for a command's arguments, new for every command line, because one process may run several command lines
  /// (the headset app does). It lives as long as the console.
  template <class Arguments>
  Arguments& arguments() {
    auto made = std::make_shared<Arguments>();
    Arguments& out = *made;
    kept_.push_back(std::move(made));
    return out;
  }

  static void print(const nlohmann::json& j) {
    SummaryOutput::write(dump(j, 2, false, nlohmann::json::error_handler_t::replace) + "\n");
  }
  /// Prints only the requested form, and does not compute the other one.
  template <class Json, class Text>
  void print(Json&& as_json, Text&& as_text) const {
    json ? print(as_json()) : fmt::print("{}", as_text());
  }

 private:
  std::vector<std::shared_ptr<void>> kept_;
};

/// A message shortened for printing, because it may contain keys and file names of any length.
inline std::string message_of(const std::string& text) {
  constexpr std::size_t kMost = 2000;
  return text.size() > kMost ? text.substr(0, kMost) + "…" : text;
}

/// Declares the command and its options.
using AddCommand = void(CLI::App&, Console&);
AddCommand add_list, add_validate, add_plan, add_run, add_run_child, add_study, add_report, add_import, add_check,
    add_compare, add_render, add_xr, add_conformance;

/// The rendering for --with-rendering, from an image size.
Rendering rendering_of(const std::string& eye);

/// Options of every command that runs a solver: --device, --device-profile, --validate.
struct DeviceFlags {
  DeviceOptions options;
  void add_to(CLI::App&);
};

/// Options of commands that run solvers: the solvers, their settings, the device.
struct SolverFlags {
  std::vector<std::string> solvers, set;
  DeviceFlags device;
  /// `option`: "--solver", or "solver" for a positional one.
  void add_to(CLI::App&, const std::string& option, const std::string& help, const std::string& set_help);
  std::vector<ChosenSolver> chosen(const std::vector<std::string>& by_default) const;
};

/// --sustained[=SECONDS]: windows at the scene's frame rate instead of trials.
struct SustainedFlag {
  std::string seconds;  ///< empty: not given
  void add_to(CLI::App&);
  void apply_to(RunPlan&) const;  ///< throws Error if the length is not 1 s to a day
};

/// Options that decide how a command executes a plan.
struct RunFlags {
  std::string out;  ///< empty: results/runs/<study>-<UTC>
  bool resume = false;
  bool part = false;  ///< the plan has only some runs of the study: no report is printed at the end
  int jobs = 1;
  std::string eye = {};  ///< size of the images that the plan renders
  DeviceFlags device = {};
};

/// Creates the folder of a plan, calls `before_runs` if the folder is usable, and executes the plan in worker
/// processes. Prints faults, tables and summary, and sets the exit code.
void execute_study(const RunPlan&, StudyManifest, const RunFlags&, Console&,
                   const std::function<void()>& before_runs = {});

/// Adds an option or positional that names solvers; "plugin:PATH" becomes the name of the solver in that library.
CLI::Option* add_solvers(CLI::App&, const std::string& option, std::vector<std::string>& names,
                         const std::string& help);

/// --require-assets: procedural rooms or hands are an Error.
void add_require_assets(CLI::App&, bool& required);
inline Assets asset_policy(bool required) { return required ? Assets::Required : Assets::MayBeProcedural; }

/// "1200x900" as width and height [pixels], 1 to 16384 each. Throws Error naming the option.
std::pair<int, int> pixels_of(const std::string& option, const std::string& text);

}  // namespace clothbench
