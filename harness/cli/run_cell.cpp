#include "cli/command.hpp"
#include "runner/cell_process.hpp"

namespace clothbench {

void add_run_cell(CLI::App& app, Console& console) {
  std::string& folder = console.arguments<std::string>();
  CLI::App* cmd =
      app.add_subcommand("run-cell", "Cells in this process, for a study that runs them in processes of their own");
  cmd->group("");  // not for people
  cmd->add_option("folder", folder)->required();
  cmd->callback([&console, &folder] { console.exit_code = static_cast<ExitCode>(run_cell_main(folder, find_solver)); });
}

}  // namespace clothbench
