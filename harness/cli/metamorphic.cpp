#include "runner/metamorphic.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/table.hpp"
#include "cli/command.hpp"

namespace clothbench {
namespace {

struct MetamorphicArguments {
  SolverFlags with;
  std::string readme;
};

std::string run(const MetamorphicResult& r) {
  if (!std::isfinite(r.distance)) return r.status;
  const std::string figure = r.bitwise ? "0 bits" : fmt::format("{:.1e}", r.distance);
  if (r.status == "pass" && r.at_most > 1e-4) return fmt::format("pass ({}, own error {:.1e})", figure, r.at_most);
  return fmt::format("{} ({})", r.status, figure);
}

Table table_of(const std::string& solver, const std::vector<MetamorphicResult>& results) {
  Table t{fmt::format("Metamorphic properties of {}", solver),
          "Greatest distance from the expected motion over all vertices and frames, divided by the longer "
          "side; \"0 bits\": no bit differs.",
          {{"property", "what changes"}}};
  for (const MetamorphicProperty& p : metamorphic_properties()) {
    std::vector<std::string> row = {p.name, p.doc};
    for (const MetamorphicResult& r : results) {
      if (r.property != p.name) continue;
      if (t.rows.size() == 1) t.rows[0].push_back(r.scene);
      row.push_back(run(r));
    }
    t.rows.push_back(std::move(row));
  }
  return t;
}

}  // namespace

void add_metamorphic(CLI::App& app, Console& console) {
  MetamorphicArguments& a = console.arguments<MetamorphicArguments>();
  CLI::App* cmd =
      app.add_subcommand("metamorphic",
                         "Test properties of a solver that need no reference solution: similarity, mirror, rotation, "
                         "renumbering, flip, repeat, no-op, restart");
  a.with.add_to(*cmd, "solver", "Solvers; default: all", "Setting of the solver: solver.substeps=20");
  cmd->add_option("--readme", a.readme,
                  "Also write the tables between the marks <!-- metamorphic begin/end --> of this file");
  a.with.device.add_to(*cmd);
  cmd->footer("Example: clothbench metamorphic xpbd --set solver.substeps=8");
  cmd->callback([&console, &a] {
    a.with.of_solver("the scenes are fixed; expected solver.<name>=<value>");
    const std::vector<Scene> scenes = metamorphic_scenes();
    nlohmann::json all = nlohmann::json::array();
    std::string markdown;
    Guard guard(console.words);
    for (const auto& [entry, settings, setting] : a.with.chosen(solver_names())) {
      const std::string& name = entry->info.name;
      std::vector<MetamorphicResult> results;
      {
        StatusLine line(!console.json);
        for (const Scene& scene : scenes) {
          const auto some = ask_metamorphic(guard, *entry, settings, a.with.device.options, scene,
                                            [&](const std::string& what) { line.show(what, 0, 0); });
          results.insert(results.end(), some.begin(), some.end());
        }
      }
      const Table t = table_of(name, results);
      for (const MetamorphicResult& r : results) all.push_back(metamorphic_json(name, r));
      if (!console.json) fmt::print("{}\n", t.console());
      markdown += t.markdown() + "\n";
    }
    if (console.json) fmt::print("{}\n", all.dump(2));
    if (guard.crashed()) console.exit_code = ExitCode::CheckFailed;
    if (!a.readme.empty()) write_between_marks(a.readme, "metamorphic", markdown);
  });
}

}  // namespace clothbench
