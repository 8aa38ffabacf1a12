#include "cli/command.hpp"
#include "runner/cell_process.hpp"

namespace clothbench {

void add_run_cell(CLI::App& app, Console& console) {
  static std::string request, answer;
  CLI::App* cmd =
      app.add_subcommand("run-cell", "One cell in this process, for a study that runs each in one of its own");
  cmd->group("");  // not for people
  cmd->add_option("request", request)->required();
  cmd->add_option("answer", answer)->required();
  cmd->callback([&console] { console.exit_code = static_cast<ExitCode>(run_cell_main(request, answer, find_solver)); });
}

}  // namespace clothbench
