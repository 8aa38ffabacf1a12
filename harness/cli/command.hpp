#pragma once
#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"
#include "scenario/load.hpp"

namespace clothbench {

/// State shared by all commands. A command adds itself to the app and runs in its callback; it throws Error on failure.
struct Console {
  bool json = false;  ///< print a machine-readable summary instead of tables
  std::string command_line;
  std::vector<std::string> words;  ///< the same, after the program's name
  ExitCode exit_code = ExitCode::Ok;
  std::set<std::string> reported_scenes = {};  ///< scenes whose drawn parameters (--seed) have been printed

  /// Storage for a command's arguments: a new object for every command line, since one process may run several (an
  /// app's session does). They live as long as the console.
  template <class Arguments>
  Arguments& arguments() {
    auto made = std::make_shared<Arguments>();
    Arguments& out = *made;
    kept_.push_back(std::move(made));
    return out;
  }

 private:
  std::vector<std::shared_ptr<void>> kept_;
};

void add_list(CLI::App&, Console&);
void add_validate(CLI::App&, Console&);
void add_plan(CLI::App&, Console&);
void add_moduli(CLI::App&, Console&);
void add_run(CLI::App&, Console&);
void add_run_child(CLI::App&, Console&);
void add_study(CLI::App&, Console&);
void add_report(CLI::App&, Console&);
void add_import(CLI::App&, Console&);
void add_check(CLI::App&, Console&);
void add_compare(CLI::App&, Console&);
void add_history(CLI::App&, Console&);
void add_completion(CLI::App&, Console&);
void add_manual(CLI::App&, Console&);
void add_bench(CLI::App&, Console&);
void add_render(CLI::App&, Console&);
void add_xr(CLI::App&, Console&);
void add_metamorphic(CLI::App&, Console&);
void add_threshold(CLI::App&, Console&);
void add_friction(CLI::App&, Console&);
void add_conformance(CLI::App&, Console&);

/// Replaces the text between the lines "<!-- NAME begin -->" and "<!-- NAME end -->" of a README. Throws Error
/// naming the file and the lines if they are missing.
void write_between_marks(const std::string& file, const std::string& name, const std::string& text);

/// `--set` arguments: `solver.<name>=<JSON>` go to the solver, everything else to the scene.
struct Overrides {
  std::vector<std::string> scene;
  nlohmann::json solver = nlohmann::json::object();
  std::string label() const;  ///< short name of the solver part, "default" if empty
};
Overrides split_overrides(const std::vector<std::string>& set);

/// Options of every command that runs a solver: --device, --validate, --allow-no-device.
struct DeviceFlags {
  DeviceOptions options;
  bool allow_no_device = false;
  void add_to(CLI::App&);
};

/// A solver of a command, with complete settings and their short name.
struct ChosenSolver {
  const SolverEntry* entry;
  nlohmann::json settings;
  std::string setting;
};
ChosenSolver chosen_solver(const std::string& name, const Overrides&);

/// Names of all solvers, or of those that `are` accepts.
std::vector<std::string> solver_names(bool (*are)(const SolverInfo&) = nullptr);

/// Scene files below these folders of the scenarios, as commands name them.
std::vector<std::string> scene_names(const std::vector<std::string>& folders);

/// What `list` takes.
std::vector<std::string> list_names();

/// Options of commands that run solvers: which, with which settings, on which device.
struct SolverFlags {
  std::vector<std::string> solvers, set;
  DeviceFlags device;
  /// `option`: "--solver", or "solver" for a positional one.
  void add_to(CLI::App&, const std::string& option, const std::string& help, const std::string& set_help);
  std::vector<ChosenSolver> chosen(const std::vector<std::string>& by_default) const;
  /// For commands whose scenes are fixed: the overrides are the solver's alone. Throws Error with `expected` if not.
  Overrides of_solver(const std::string& expected) const;
};

/// "1200x900" as width and height [pixels], 1 to 16384 each. Throws Error naming the option.
std::pair<int, int> pixels_of(const std::string& option, const std::string& text);

/// An option or positional that names solvers; "plugin:PATH" becomes the name of the solver in that library.
CLI::Option* add_solvers(CLI::App&, const std::string& option, std::vector<std::string>& names,
                         const std::string& help);

/// --require-assets: using stand-ins for rooms and hands is an Error.
void add_require_assets(CLI::App&, bool& required);
inline Assets asset_policy(bool required) { return required ? Assets::Required : Assets::MayBeProcedural; }

/// A line on the terminal that is rewritten in place; prints nothing into a pipe.
class StatusLine {
 public:
  explicit StatusLine(bool enabled);
  ~StatusLine();
  void show(const std::string& what, std::size_t done, std::size_t total);

 private:
  bool enabled_;
  double start_s_;
  std::size_t width_ = 0;
};

}  // namespace clothbench
