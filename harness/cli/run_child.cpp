#include "cli/command.hpp"
#include "runner/conformance.hpp"
#include "runner/study_plan.hpp"

namespace clothbench {

void add_run_child(CLI::App& app, Console& console) {
  CLI::App* cmd = app.add_subcommand("run-child", "Execute what another process of this program asks for");
  cmd->group("");  // not for people
  cmd->callback([&console] {
    const auto silent = [](nlohmann::json (*work)(const nlohmann::json&)) {
      return [work](const nlohmann::json& request, const WorkerProgress&) { return work(request); };
    };
    const auto plan = [](const nlohmann::json& request, const WorkerProgress& progress) {
      return execute_plan(request, progress, known_solver, rendering_of);
    };
    console.exit_code = static_cast<ExitCode>(run_child_main(
        {{"plan", plan}, {"plan-of-solver", silent(plan_answer)}, {"conformance", silent(conformance_answer)}}));
  });
}

}  // namespace clothbench
