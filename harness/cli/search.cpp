// Studies in which each result decides the next run: moduli, friction, threshold, metamorphic.
#include "cli/command.hpp"
#include "report/friction.hpp"
#include "report/material.hpp"
#include "report/metamorphic.hpp"

namespace clothbench {
namespace {

struct SearchFlags : SolverFlags {
  std::string out;
  bool resume = false;

  void add_storage_to(CLI::App& app) {
    CLI::Option* folder = app.add_option("--out", out, "Also store every run in this folder, for `clothbench report`");
    app.add_flag("--resume", resume, "Continue with the runs stored in that folder")->needs(folder);
    device.add_to(app);
  }
  /// With a status line. The exit code is by the one rule (runner/solver_ends.hpp).
  std::vector<RunRecord> runs(Console& console, const std::function<Searched(const SearchCall&)>& search) const {
    StatusLine line(console.shows_status());
    SearchCall call{solvers, set, out, resume, device, console.command_line, console.words};
    call.progress = [&](const std::string& what, std::size_t done) { line.show(what, done); };
    Searched found = search(call);
    SolverEnds ends;
    for (const RunRecord& r : found.runs) ends.add(r.header.solver, r.outcome);
    if (found.crashed || !ends.faults().empty()) console.exit_code = ExitCode::CheckFailed;
    for (const std::string& fault : ends.faults()) fmt::print(stderr, "FAULT {}\n", fault);
    return std::move(found.runs);
  }
};

std::string printed(const std::vector<Table>& tables, const char* after = "") {
  std::string text;
  for (const Table& t : tables) text += t.console() + after;
  return text;
}

struct ModuliArguments : SearchFlags {
  bool no_sweep = false;
};

std::string moduli_text(const std::vector<RunRecord>& runs) {
  const auto materials = solver_materials(runs);
  std::string text = printed({material_table(materials), material_verdicts(materials)});
  for (const RunRecord& c : runs)
    if (!c.outcome.message.empty())
      text += fmt::format("  {} {}: {}\n", c.header.solver, c.header.setting, c.outcome.message);
  return text;
}

struct FrictionArguments : SearchFlags {
  std::vector<int> substeps;
};

void tell_friction(const std::vector<RunRecord>& runs, Console& console) {
  console.print([&] { return friction_json(runs); }, [&] { return friction_table(runs).console() + "\n"; });
  for (const std::string& crash : friction_crashes(runs)) {
    fmt::print(stderr, "{}\n", crash);
    console.exit_code = ExitCode::CheckFailed;
  }
}

struct ThresholdArguments : SearchFlags {
  std::vector<std::string> scenes = {"validation/incline-stick", "validation/capstan-hold"};
};

void tell_thresholds(const std::vector<RunRecord>& runs, Console& console) {
  nlohmann::json all = nlohmann::json::array();
  std::string text;
  for (const ThresholdRow& row : threshold_rows(runs)) {
    if ((row.found.failed && row.unsupported.empty()) || !row.crash.empty()) console.exit_code = ExitCode::CheckFailed;
    all.push_back(threshold_json(row));
    text += threshold_sentence(row) + "\n";
  }
  console.print([&] { return all; }, [&] { return text; });
}

}  // namespace

void add_moduli(CLI::App& app, Console& console) {
  ModuliArguments& a = console.arguments<ModuliArguments>();
  CLI::App* cmd = app.add_subcommand(
      "moduli",
      "Measure the effective stiffness of solvers: moduli at 0, 45 and 90 degrees, bending, of grids and of "
      "irregular triangle meshes, and their dependence on settings");
  a.add_to(*cmd, "solver", "Solvers; default: all", "Setting of the solver: solver.substeps=20");
  cmd->add_flag("--no-sweep", a.no_sweep,
                "Measure at the given settings only, not also with four times the substeps and iterations");
  a.add_storage_to(*cmd);
  cmd->footer("Example: clothbench moduli xpbd --set solver.substeps=64");
  cmd->callback([&] {
    const auto runs = a.runs(console, [&](const SearchCall& call) { return search_moduli(call, !a.no_sweep); });
    console.print([&] { return material_json(solver_materials(runs)); }, [&] { return moduli_text(runs); });
  });
}

void add_friction(CLI::App& app, Console& console) {
  FrictionArguments& a = console.arguments<FrictionArguments>();
  CLI::App* cmd = app.add_subcommand(
      "friction", "Compare solvers with the closed forms of friction: slopes, stopping, capstan, Atwood's strip");
  add_solvers(*cmd, "solver", a.solvers, "Solvers; default: all that handle contact");
  cmd->add_option("--substeps", a.substeps,
                  "Also run with these numbers of substeps per frame, for solvers with that setting");
  cmd->add_option("--set", a.set, "Override in every run: solver.substeps=20");
  a.add_storage_to(*cmd);
  cmd->footer("Example: clothbench friction xpbd bullet-soft --substeps 8 32");
  cmd->callback([&] {
    const auto runs = a.runs(console, [&](const SearchCall& call) { return search_friction(call, a.substeps); });
    tell_friction(runs, console);
  });
}

void add_threshold(CLI::App& app, Console& console) {
  ThresholdArguments& a = console.arguments<ThresholdArguments>();
  CLI::App* cmd = app.add_subcommand(
      "threshold",
      "Find by bisection the smallest friction at which a scene holds, and compare it with the closed form");
  cmd->add_option("scene", a.scenes, "Scenes at rest on a slope or over a cylinder")->capture_default_str();
  a.add_to(*cmd, "--solver", "Solvers (default xpbd)", "Override: cloth.grid=[17,17], solver.substeps=20");
  a.add_storage_to(*cmd);
  cmd->footer("Example: clothbench threshold validation/incline-stick --solver xpbd --solver bullet-soft");
  cmd->callback([&] {
    const auto search = [&](const SearchCall& call) { return search_thresholds(call, a.scenes); };
    tell_thresholds(a.runs(console, search), console);
  });
}

void add_metamorphic(CLI::App& app, Console& console) {
  SearchFlags& a = console.arguments<SearchFlags>();
  CLI::App* cmd =
      app.add_subcommand("metamorphic",
                         "Test properties of a solver that need no reference solution: similarity, mirror, rotation, "
                         "renumbering, flip, repeat, no-op, restart");
  a.add_to(*cmd, "solver", "Solvers; default: all", "Setting of the solver: solver.substeps=20");
  a.add_storage_to(*cmd);
  cmd->footer("Example: clothbench metamorphic xpbd --set solver.substeps=8 --out results/runs/relations");
  cmd->callback([&] {
    const auto runs = a.runs(console, search_metamorphic);
    console.print([&] { return metamorphic_json(runs); }, [&] { return printed(metamorphic_tables(runs), "\n"); });
  });
}

}  // namespace clothbench
