#include "cli/command.hpp"
#include "studies/plans.hpp"

namespace clothbench {
namespace {

struct PlanArguments {
  std::vector<std::string> scenes;
  SolverFlags with;
};

}  // namespace

void add_plan(CLI::App& app, Console& console) {
  PlanArguments& a = console.arguments<PlanArguments>();
  CLI::App* cmd = app.add_subcommand(
      "plan", "Print what a solver would run for a scene: kernels, dispatches, buffers, bytes and omitted features");
  cmd->add_option("scene", a.scenes, "Scenario files or names")->required();
  a.with.add_to(*cmd, "--solver", "Solvers; default: all", "Override: cloth.grid=[64,64], solver.substeps=20");
  a.with.device.add_to(*cmd);
  cmd->footer(
      "Examples: clothbench plan paper/gravity --solver paper\n"
      "          clothbench plan paper/desk-flat-low --solver xpbd --set cloth.grid=[64,64] --json");
  cmd->callback([&console, &a] {
    nlohmann::json all = nlohmann::json::array();
    Guard guard(console.words);
    for (const std::string& file : a.scenes) {
      const Scene scene = load_scene(file, split_overrides(a.with.set).scene);
      for (const ChosenSolver& s : a.with.chosen(solver_names())) {
        all.push_back(ask_plan(guard, scene, s, a.with.device.options));
        if (!console.json) fmt::print("{}", plan_text(all.back()));
        if (all.back()["status"] == "error" || guard.crashed()) console.exit_code = ExitCode::CheckFailed;
      }
    }
    if (console.json) console.print(all);
  });
}

}  // namespace clothbench
