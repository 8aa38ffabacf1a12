#include <fmt/format.h>

#include "cli/run_common.hpp"
#include "report/material.hpp"
#include "runner/effective_moduli.hpp"

namespace clothbench {
namespace {

struct ModuliArguments {
  SearchFlags search;
  bool no_sweep = false;
};

/// The measurement at the settings given, and short ones where it is looked whether it holds.
void measure(const ChosenSolver& solver, const ModuliArguments& a, Guard& guard, StudyRuns& runs, StatusLine& line,
             std::vector<RunRecord>& out) {
  const auto& [at, settings, setting] = solver;
  const SolverEntry& entry = *at;
  const auto one = [&](const nlohmann::json& s, const std::string& label, bool full) {
    line.show(entry.info.name + " " + label, out.size(), 0);
    try {
      out.push_back(ask_material(guard, runs, entry, s, label, full));
    } catch (const Error& e) {
      if (e.code() != ExitCode::NoDevice || !a.search.device.allow_no_device) throw;
      if (full) fmt::print(stderr, "no Vulkan device is present: {} is left out\n", entry.info.name);
    }
  };
  one(settings, setting, true);
  // Whatever came of it: a plugin's child asks the same questions without knowing the answers.
  if (a.no_sweep || entry.info.ignores.has(Feature::Stretch)) return;
  for (const auto& [label, s] : swept_settings(entry.info, settings)) one(s, label, false);
}

}  // namespace

void add_moduli(CLI::App& app, Console& console) {
  ModuliArguments& a = console.arguments<ModuliArguments>();
  CLI::App* cmd = app.add_subcommand(
      "moduli",
      "Measure the effective stiffness of solvers: moduli at 0, 45 and 90 degrees, bending, and their "
      "dependence on settings");
  a.search.add_to(*cmd, "solver", "Solvers; default: all", "Setting of the solver: solver.substeps=20");
  cmd->add_flag("--no-sweep", a.no_sweep,
                "Measure at the given settings only, not also with four times the substeps and iterations");
  a.search.add_storage_to(*cmd);
  cmd->footer("Example: clothbench moduli xpbd --set solver.substeps=64");
  cmd->callback([&console, &a] {
    a.search.of_solver("expected solver.<name>=<value>; the patches are fixed");
    if (a.search.solvers.empty())
      a.search.solvers = solver_names([](const SolverInfo& s) { return !s.ignores.has(Feature::Stretch); });
    std::vector<RunRecord> moduli;
    Guard guard(console.words);
    StudyRuns runs = a.search.runs("moduli", console);
    {
      StatusLine line(!console.json);
      for (const ChosenSolver& solver : a.search.chosen({})) measure(solver, a, guard, runs, line, moduli);
    }
    if (guard.crashed()) console.exit_code = ExitCode::CheckFailed;
    const auto materials = solver_materials(moduli);
    if (console.json) {
      fmt::print("{}\n", material_json(materials).dump(2));
      return;
    }
    fmt::print("{}{}", material_table(materials).console(), material_verdicts(materials).console());
    for (const RunRecord& c : moduli)
      if (!c.outcome.message.empty()) fmt::print("  {} {}: {}\n", c.header.solver, c.header.setting, c.outcome.message);
  });
}

}  // namespace clothbench
