#include "runner/conformance.hpp"

#include "base/words.hpp"
#include "cli/command.hpp"

namespace clothbench {
namespace {

struct ConformanceArguments {
  SolverFlags with;
  std::vector<std::string> scenes;
  bool no_whole = false;
  double limit_s = 20;
};

void run(const ConformanceArguments& a, Console& console) {
  for (const std::string& key : split_overrides(a.with.set).scene)
    throw Error("--set " + shortened(key, 200) + ": the scenes are fixed; expected solver.<name>=<value>");
  const std::vector<std::string> scenes = conformance_scenes(a.scenes);
  nlohmann::json all = nlohmann::json::array();
  int passed = 0, failed = 0, skipped = 0;
  Worker worker;
  for (const auto& [entry, settings, setting] : a.with.chosen({}))
    for (const std::string& scene : scenes) {
      const nlohmann::json row =
          ask_conformance(worker, *entry, settings, a.with.device.options, scene, !a.no_whole, a.limit_s);
      (row["status"] == "pass" ? passed : row["status"] == "skipped" ? skipped : failed) += 1;
      all.push_back(row);
      all.back()["solver"] = entry->info.name;
      all.back()["setting"] = setting;
      if (!console.json) fmt::print("{}", conformance_text(entry->info.name, row));
      std::fflush(stdout);
    }
  if (failed > 0 || passed == 0) console.exit_code = ExitCode::CheckFailed;
  if (console.json) return Console::print(all);
  fmt::print("{} scenes pass, {} fail, {} skipped\n", passed, failed, skipped);
  if (passed + failed == 0) fmt::print("nothing was tested: the solver supports none of these scenes\n");
}

}  // namespace

void add_conformance(CLI::App& app, Console& console) {
  ConformanceArguments& a = console.arguments<ConformanceArguments>();
  CLI::App* cmd = app.add_subcommand(
      "conformance",
      "Check the requirements on every solver: stages, start, pins, attachments, finite positions, reset; on small "
      "grids and whole scenes of paper, contact, validation and conformance");
  a.with.add_to(*cmd, "solver", "Solvers", "Setting of the solver: solver.substeps=20");
  cmd->get_option("solver")->required();
  cmd->add_option("--scene", a.scenes, "Only these scenes, such as paper/gravity");
  cmd->add_flag("--no-whole", a.no_whole, "Six frames on small grids only, no whole scenes");
  cmd->add_option("--limit", a.limit_s, "A whole scene is cut off after this much time in the solver [s]; 0: never")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  a.with.device.add_to(*cmd);
  cmd->footer(
      "Examples: clothbench conformance plugin:mine.so\n"
      "          clothbench conformance xpbd --scene paper/gravity --scene contact/sphere");
  cmd->callback([&console, &a] { run(a, console); });
}

}  // namespace clothbench
