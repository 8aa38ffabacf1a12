#include "cli/command.hpp"

namespace clothbench {
namespace {

struct RunArguments {
  std::vector<std::string> scenes;
  SolverFlags with;
  std::string out;
  int trials = 1;
  bool require_assets = false, resume = false;
  SustainedFlag sustained;
};

}  // namespace

void add_run(CLI::App& app, Console& console) {
  RunArguments& a = console.arguments<RunArguments>();
  CLI::App* cmd =
      app.add_subcommand("run", "Run scenes with solvers: one accuracy pass over the whole scene, then timed trials");
  cmd->add_option("scene", a.scenes, "Scene files or names")->required();
  a.with.add_to(*cmd, "--solver", "Solvers (default xpbd)", "Override: cloth.grid=[64,64], solver.substeps=20");
  cmd->add_option("--trials", a.trials, "Timed trials")->check(CLI::Range(0, 1000))->capture_default_str();
  a.sustained.add_to(*cmd);
  cmd->add_option("--out", a.out, "Folder for the result files; default results/runs/run-<UTC>");
  add_require_assets(*cmd, a.require_assets);
  cmd->add_flag("--resume", a.resume, "Continue the interrupted run in the folder of --out");
  a.with.device.add_to(*cmd);
  cmd->footer(
      "Example: clothbench run paper/gravity --solver paper --set cloth.grid=[64,64] --set solver.iterations=20");
  cmd->callback([&console, &a, cmd] {
    if (a.resume && a.out.empty()) throw Error("--resume needs --out DIR, the folder of the interrupted run");
    const std::vector<std::string> set = split_overrides(a.with.set).scene;
    std::vector<Scene> scenes;
    for (const std::string& file : a.scenes) scenes.push_back(load_scene(file, set, asset_policy(a.require_assets)));
    RunPlan plan;
    plan.protocol = "run";
    plan.rules.trials = a.trials;
    plan.rules.max_wall_s = 10;
    plan.rules.accuracy_duration_s = 0;
    for (const Scene& scene : scenes) {
      plan.rules.accuracy_duration_s = std::max(plan.rules.accuracy_duration_s, scene.time.duration_s);
      std::vector<RunSpec> group;
      for (auto& [entry, settings, setting] : a.with.chosen({"xpbd"}))
        group.push_back({&scene, entry, settings, setting});
      plan.groups.push_back(std::move(group));
    }
    if (!a.sustained.seconds.empty() && cmd->count("--trials") > 0)
      throw Error("--sustained excludes --trials; leave one out");
    a.sustained.apply_to(plan);
    StudyManifest manifest;
    manifest.study = "run";
    execute_study(plan, manifest, {.out = a.out, .resume = a.resume, .device = a.with.device}, console);
  });
}

}  // namespace clothbench
