#include "runner/friction.hpp"

#include <fmt/format.h>

#include "cli/run_common.hpp"
#include "report/friction.hpp"

namespace clothbench {
namespace {

struct FrictionArguments {
  SearchFlags search;
  std::vector<int> substeps;
  std::string readme;
};

struct ThresholdArguments {
  std::vector<std::string> scenes = {"validation/incline-stick", "validation/capstan-hold"};
  SearchFlags search;
};

/// The settings given, and those with each number of substeps where the solver has that setting.
std::vector<nlohmann::json> settings_of(const SolverInfo& solver, const nlohmann::json& given,
                                        const std::vector<int>& substeps) {
  std::vector<nlohmann::json> out = {given};
  if (!complete_settings(solver, nlohmann::json::object()).contains("substeps")) return out;
  for (const int n : substeps) {
    out.push_back(given);
    out.back()["substeps"] = n;
  }
  return out;
}

void run_friction(FrictionArguments& a, Console& console) {
  const Overrides overrides = split_overrides(a.search.set);
  if (a.search.solvers.empty())
    a.search.solvers = solver_names([](const SolverInfo& s) { return !(s.supports & kColliderFeatures).empty(); });
  Guard guard(console.words);
  StudyRuns study = a.search.runs("friction", console);
  std::vector<RunRecord> runs;
  {
    StatusLine line(!console.json);
    for (const std::string& name : a.search.solvers) {
      const SolverEntry& entry = find_solver(name);
      for (const nlohmann::json& given : settings_of(entry.info, overrides.solver, a.substeps)) {
        const std::string label = Overrides{{}, given}.label();
        const auto some = friction_runs(
            guard, study, entry, complete_settings(entry.info, given), label, overrides.scene,
            [&](const std::string& scene) { line.show(fmt::format("{} {}: {}", name, label, scene), 0, 0); });
        runs.insert(runs.end(), some.begin(), some.end());
      }
    }
  }
  if (console.json)
    fmt::print("{}\n", friction_json(runs).dump(2));
  else
    fmt::print("{}\n", friction_table(runs).console());
  for (const std::string& crash : friction_crashes(runs)) {
    fmt::print(stderr, "{}\n", crash);
    console.exit_code = ExitCode::CheckFailed;
  }
  if (!a.readme.empty()) write_between_marks(a.readme, "friction", friction_table(runs).markdown());
}

void run_threshold(ThresholdArguments& a, Console& console) {
  const std::vector<std::string> set = split_overrides(a.search.set).scene;
  if (a.search.solvers.empty()) a.search.solvers = {"xpbd"};
  nlohmann::json all = nlohmann::json::array();
  Guard guard(console.words);
  StudyRuns runs = a.search.runs("threshold", console);
  for (const std::string& file : a.scenes)
    for (const auto& [entry, settings, setting] : a.search.chosen({})) {
      const std::vector<ThresholdRow> rows =
          threshold_rows(threshold_runs(guard, runs, load_scene(file, set), *entry, settings, setting));
      for (const ThresholdRow& row : rows) {
        if ((row.found.failed && row.unsupported.empty()) || !row.crash.empty())
          console.exit_code = ExitCode::CheckFailed;
        all.push_back(threshold_json(row));
        if (!console.json) fmt::print("{}\n", threshold_sentence(row));
      }
    }
  if (console.json) fmt::print("{}\n", all.dump(2));
}

}  // namespace

void add_friction(CLI::App& app, Console& console) {
  FrictionArguments& a = console.arguments<FrictionArguments>();
  CLI::App* cmd = app.add_subcommand(
      "friction", "Compare solvers with the closed forms of friction: slopes, stopping, capstan, Atwood's strip");
  add_solvers(*cmd, "solver", a.search.solvers, "Solvers; default: all that handle contact");
  cmd->add_option("--substeps", a.substeps,
                  "Also run with these numbers of substeps per frame, for solvers with that setting");
  cmd->add_option("--set", a.search.set, "Override in every run: solver.contact_samples=0");
  cmd->add_option("--readme", a.readme,
                  "Also write the table between the marks <!-- friction begin/end --> of this file");
  a.search.add_storage_to(*cmd);
  cmd->footer("Example: clothbench friction xpbd bullet-soft --substeps 8 32");
  cmd->callback([&console, &a] { run_friction(a, console); });
}

void add_threshold(CLI::App& app, Console& console) {
  ThresholdArguments& a = console.arguments<ThresholdArguments>();
  CLI::App* cmd = app.add_subcommand(
      "threshold",
      "Find by bisection the smallest friction at which a scene holds, and compare it with the closed form");
  cmd->add_option("scene", a.scenes, "Scenes at rest on a slope or over a cylinder")->capture_default_str();
  a.search.add_to(*cmd, "--solver", "Solvers (default xpbd)", "Override: cloth.grid=[17,17], solver.substeps=20");
  a.search.add_storage_to(*cmd);
  cmd->footer("Example: clothbench threshold validation/incline-stick --solver xpbd --solver bullet-soft");
  cmd->callback([&console, &a] { run_threshold(a, console); });
}

}  // namespace clothbench
