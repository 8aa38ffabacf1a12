#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "cli/command.hpp"
#include "report/table.hpp"
#include "runner/metamorphic.hpp"
#include "runner/threshold.hpp"
#include "truth/card.hpp"

namespace clothbench {
namespace {

struct Arguments {
  std::vector<std::string> solvers, set;
  std::string readme;
  DeviceFlags device;
};

struct ThresholdArguments {
  std::vector<std::string> scenes = {"validation/incline-stick", "validation/capstan-hold"}, solvers, set;
  DeviceFlags device;
};

std::string cell(const MetamorphicResult& r) {
  if (!std::isfinite(r.distance)) return r.status;
  const std::string figure = r.bitwise ? "0 bits" : fmt::format("{:.1e}", r.distance);
  if (r.status == "kept" && r.at_most > 1e-4) return fmt::format("kept ({}, own error {:.1e})", figure, r.at_most);
  return fmt::format("{} ({})", r.status, figure);
}

Table table_of(const std::string& solver, const std::vector<MetamorphicResult>& results) {
  Table t{fmt::format("Metamorphic properties of {}", solver),
          "Greatest distance from what it should be, of all vertices and frames, over the longer side; \"0 bits\": no bit differs.",
          {{"property", "what changes"}}};
  for (const MetamorphicProperty& p : metamorphic_properties()) {
    std::vector<std::string> row = {p.name, p.doc};
    for (const MetamorphicResult& r : results) {
      if (r.property != p.name) continue;
      if (t.rows.size() == 1) t.rows[0].push_back(r.scene);
      row.push_back(cell(r));
    }
    t.rows.push_back(std::move(row));
  }
  return t;
}

nlohmann::json json_of(const std::string& solver, const MetamorphicResult& r) {
  const auto number = [](double x) { return std::isfinite(x) ? nlohmann::json(x) : nlohmann::json(); };
  return {{"solver", solver}, {"property", r.property}, {"scene", r.scene}, {"status", r.status}, {"distance", number(r.distance)},
          {"bitwise", r.bitwise}, {"at_most", r.at_most}};
}

}  // namespace

void add_metamorphic(CLI::App& app, Console& console) {
  static Arguments a;
  a = {};
  CLI::App* cmd = app.add_subcommand("metamorphic", "Properties of a solver that need no truth: similarity, mirror, rotation, renumbering, repeat, no-op, restart");
  add_solvers(*cmd, "solver", a.solvers, "Solvers; default: all");
  cmd->add_option("--set", a.set, "Setting of the solver: solver.substeps=20");
  cmd->add_option("--readme", a.readme, "Also write the tables between the marks <!-- metamorphic begin/end --> of this file");
  a.device.add_to(*cmd);
  cmd->callback([&console] {
    const Overrides overrides = split_overrides(a.set);
    if (!overrides.scene.empty()) throw Error("--set " + overrides.scene[0] + ": the scenes are fixed; expected solver.<name>=<value>");
    if (a.solvers.empty())
      for (const SolverEntry& e : solvers()) a.solvers.push_back(e.info.name);
    const std::vector<Scene> scenes = metamorphic_scenes();
    nlohmann::json all = nlohmann::json::array();
    std::string markdown;
    for (const std::string& name : a.solvers) {
      const SolverEntry& entry = find_solver(name);
      StatusLine line(!console.json);
      const auto results = run_metamorphic(entry, complete_settings(entry.info, overrides.solver), a.device.options, scenes,
                                           [&](const std::string& what) { line.show(what, 0, 0); });
      const Table t = table_of(name, results);
      for (const MetamorphicResult& r : results) all.push_back(json_of(name, r));
      if (!console.json) fmt::print("{}\n", t.console());
      markdown += t.markdown() + "\n";
    }
    if (console.json) fmt::print("{}\n", all.dump(2));
    if (!a.readme.empty()) write_between_marks(a.readme, "metamorphic", markdown);
  });
}

void add_threshold(CLI::App& app, Console& console) {
  static ThresholdArguments a;
  a = {};
  CLI::App* cmd = app.add_subcommand("threshold", "From which friction on a scene holds, found by bisection, against the closed form");
  cmd->add_option("scene", a.scenes, "Scenes at rest on a slope or over a cylinder")->capture_default_str();
  add_solvers(*cmd, "--solver", a.solvers, "Solvers (default xpbd)");
  cmd->add_option("--set", a.set, "Override: cloth.grid=[17,17], solver.substeps=20");
  a.device.add_to(*cmd);
  cmd->callback([&console] {
    const Overrides overrides = split_overrides(a.set);
    if (a.solvers.empty()) a.solvers = {"xpbd"};
    nlohmann::json all = nlohmann::json::array();
    for (const std::string& file : a.scenes)
      for (const std::string& name : a.solvers) {
        const Scene scene = load_scene(file, overrides.scene);
        const SolverEntry& entry = find_solver(name);
        const FoundThreshold found = find_threshold(scene, entry, complete_settings(entry.info, overrides.solver), a.device.options);
        const auto card = truth::card_of(scene);
        const char* bound = found.holds_at_least ? "<= " : found.slips_at_most ? ">= " : "";
        all.push_back({{"scene", scene.name}, {"solver", name}, {"exact", found.exact}, {"found", found.found}, {"error", found.error},
                       {"error_name", card->threshold->error_name}, {"error_units", card->threshold->error_units}, {"bound", bound}, {"runs", found.runs}});
        if (!console.json)
          fmt::print("{} {}: holds from friction {}{:.5f} on, exact {:.5f}; {} off by {:+.4f} {} ({} runs)\n", scene.name, name, bound, found.found,
                     found.exact, card->threshold->error_name, found.error, card->threshold->error_units, found.runs);
      }
    if (console.json) fmt::print("{}\n", all.dump(2));
  });
}

}  // namespace clothbench
