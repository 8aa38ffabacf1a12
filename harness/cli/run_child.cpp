#include "cli/command.hpp"
#include "runner/run_process.hpp"

namespace clothbench {

void add_run_child(CLI::App& app, Console& console) {
  std::string& folder = console.arguments<std::string>();
  CLI::App* cmd =
      app.add_subcommand("run-child", "Execute runs in this process, for a study that runs each in its own process");
  cmd->group("");  // not for people
  cmd->add_option("folder", folder)->required();
  cmd->callback(
      [&console, &folder] { console.exit_code = static_cast<ExitCode>(run_child_main(folder, find_solver)); });
}

}  // namespace clothbench
