#include "runner/metamorphic.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "base/table.hpp"
#include "cli/again.hpp"
#include "cli/command.hpp"
#include "runner/threshold.hpp"
#include "truth/card.hpp"

namespace clothbench {
namespace {

struct MetamorphicArguments {
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
          "Greatest distance from what it should be, of all vertices and frames, over the longer side; \"0 bits\": no "
          "bit differs.",
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
  return {{"solver", solver},    {"property", r.property},         {"scene", r.scene},
          {"status", r.status},  {"distance", number(r.distance)}, {"bitwise", r.bitwise},
          {"at_most", r.at_most}};
}

MetamorphicResult result_from(const nlohmann::json& j) {
  return {j["property"], j["scene"],  j["status"], j["distance"].is_null() ? std::nan("") : j["distance"].get<double>(),
          j["bitwise"],  j["at_most"]};
}

/// Every property on one scene; "crashed" for all of them where a plugin brings its process down at one.
std::vector<MetamorphicResult> on_scene(const SolverEntry& entry, const nlohmann::json& settings,
                                        const DeviceOptions& device, const Scene& scene, Guard& guard,
                                        const std::function<void(const std::string&)>& note) {
  const Guard::Answer answer = guard.run(entry, [&] {
    nlohmann::json rows = nlohmann::json::array();
    for (const MetamorphicResult& r : run_metamorphic(entry, settings, device, {scene}, note))
      rows.push_back(json_of(entry.info.name, r));
    return rows;
  });
  std::vector<MetamorphicResult> out;
  if (answer.crash.empty())
    for (const nlohmann::json& row : answer.value) out.push_back(result_from(row));
  else
    for (const MetamorphicProperty& p : metamorphic_properties())
      out.push_back({p.name, scene.name, "crashed: " + answer.crash, std::nan(""), false, 0});
  return out;
}

nlohmann::json threshold_json(const Scene& scene, const SolverEntry& entry, const nlohmann::json& settings,
                              const DeviceOptions& device) {
  const FoundThreshold found = find_threshold(scene, entry, settings, device);
  const auto card = truth::card_of(scene);
  const char* bound = found.holds_at_least ? "<= " : found.slips_at_most ? ">= " : "";
  const auto number = [&](double x) { return found.failed ? nlohmann::json() : nlohmann::json(x); };
  return {{"scene", scene.name},
          {"solver", entry.info.name},
          {"exact", found.exact},
          {"found", number(found.found)},
          {"error", number(found.error)},
          {"error_name", card->threshold->error_name},
          {"error_units", card->threshold->error_units},
          {"bound", bound},
          {"failed", found.failed},
          {"runs", found.runs}};
}

void print_threshold(const nlohmann::json& t) {
  const auto text = [&](const char* key) { return t[key].get<std::string>(); };
  if (t.contains("crashed"))
    return fmt::print("{} {}: its process: {}\n", text("scene"), text("solver"), text("crashed"));
  if (t["failed"].get<bool>())
    return fmt::print("{} {}: its run failed ({} runs)\n", text("scene"), text("solver"), t["runs"].get<int>());
  fmt::print("{} {}: holds from friction {}{:.5f} on, exact {:.5f}; {} off by {:+.4f} {} ({} runs)\n", text("scene"),
             text("solver"), text("bound"), t["found"].get<double>(), t["exact"].get<double>(), text("error_name"),
             t["error"].get<double>(), text("error_units"), t["runs"].get<int>());
}

}  // namespace

void add_metamorphic(CLI::App& app, Console& console) {
  MetamorphicArguments& a = console.arguments<MetamorphicArguments>();
  CLI::App* cmd = app.add_subcommand("metamorphic",
                                     "Properties of a solver that need no truth: similarity, mirror, rotation, "
                                     "renumbering, flip, repeat, no-op, restart");
  add_solvers(*cmd, "solver", a.solvers, "Solvers; default: all");
  cmd->add_option("--set", a.set, "Setting of the solver: solver.substeps=20");
  cmd->add_option("--readme", a.readme,
                  "Also write the tables between the marks <!-- metamorphic begin/end --> of this file");
  a.device.add_to(*cmd);
  cmd->footer("Example: clothbench metamorphic xpbd --set solver.substeps=8");
  cmd->callback([&console, &a] {
    const Overrides overrides = split_overrides(a.set);
    if (!overrides.scene.empty())
      throw Error("--set " + overrides.scene[0] + ": the scenes are fixed; expected solver.<name>=<value>");
    if (a.solvers.empty())
      for (const SolverEntry& e : solvers()) a.solvers.push_back(e.info.name);
    const std::vector<Scene> scenes = metamorphic_scenes();
    nlohmann::json all = nlohmann::json::array();
    std::string markdown;
    Guard guard(console);
    for (const std::string& name : a.solvers) {
      const SolverEntry& entry = find_solver(name);
      std::vector<MetamorphicResult> results;
      {
        StatusLine line(!console.json);
        for (const Scene& scene : scenes) {
          const auto some = on_scene(entry, complete_settings(entry.info, overrides.solver), a.device.options, scene,
                                     guard, [&](const std::string& what) { line.show(what, 0, 0); });
          results.insert(results.end(), some.begin(), some.end());
        }
      }
      const Table t = table_of(name, results);
      for (const MetamorphicResult& r : results) all.push_back(json_of(name, r));
      if (!console.json) fmt::print("{}\n", t.console());
      markdown += t.markdown() + "\n";
    }
    if (console.json) fmt::print("{}\n", all.dump(2));
    if (guard.crashed()) console.exit_code = ExitCode::CheckFailed;
    if (!a.readme.empty()) write_between_marks(a.readme, "metamorphic", markdown);
  });
}

void add_threshold(CLI::App& app, Console& console) {
  ThresholdArguments& a = console.arguments<ThresholdArguments>();
  CLI::App* cmd = app.add_subcommand(
      "threshold", "From which friction on a scene holds, found by bisection, against the closed form");
  cmd->add_option("scene", a.scenes, "Scenes at rest on a slope or over a cylinder")->capture_default_str();
  add_solvers(*cmd, "--solver", a.solvers, "Solvers (default xpbd)");
  cmd->add_option("--set", a.set, "Override: cloth.grid=[17,17], solver.substeps=20");
  a.device.add_to(*cmd);
  cmd->footer("Example: clothbench threshold validation/incline-stick --solver xpbd --solver bullet-soft");
  cmd->callback([&console, &a] {
    const Overrides overrides = split_overrides(a.set);
    if (a.solvers.empty()) a.solvers = {"xpbd"};
    nlohmann::json all = nlohmann::json::array();
    Guard guard(console);
    for (const std::string& file : a.scenes)
      for (const std::string& name : a.solvers) {
        const Scene scene = load_scene(file, overrides.scene);
        const SolverEntry& entry = find_solver(name);
        const Guard::Answer answer = guard.run(entry, [&] {
          return threshold_json(scene, entry, complete_settings(entry.info, overrides.solver), a.device.options);
        });
        all.push_back(answer.crash.empty()
                          ? answer.value
                          : nlohmann::json{{"scene", scene.name}, {"solver", name}, {"crashed", answer.crash}});
        if (all.back().value("failed", false)) console.exit_code = ExitCode::CheckFailed;
        if (!console.json) print_threshold(all.back());
      }
    if (guard.crashed()) console.exit_code = ExitCode::CheckFailed;
    if (console.json) fmt::print("{}\n", all.dump(2));
  });
}

}  // namespace clothbench
