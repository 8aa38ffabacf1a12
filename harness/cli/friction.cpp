#include "runner/friction.hpp"

#include <fmt/format.h>

#include <optional>
#include <set>

#include "base/table.hpp"
#include "cli/command.hpp"
#include "runner/threshold.hpp"

namespace clothbench {
namespace {

struct FrictionArguments {
  std::vector<std::string> solvers, set;
  std::vector<int> substeps;
  std::string readme;
  DeviceFlags device;
};

}  // namespace

void add_friction(CLI::App& app, Console& console) {
  FrictionArguments& a = console.arguments<FrictionArguments>();
  CLI::App* cmd = app.add_subcommand(
      "friction", "Solvers by the closed forms of friction: slopes, stopping, capstan, Atwood's strip");
  add_solvers(*cmd, "solver", a.solvers, "Solvers; default: all that touch anything");
  cmd->add_option("--substeps", a.substeps,
                  "Also at these numbers of substeps a frame, where a solver has that setting");
  cmd->add_option("--set", a.set, "Override in every run: solver.contact_samples=0");
  cmd->add_option("--readme", a.readme,
                  "Also write the table between the marks <!-- friction begin/end --> of this file");
  a.device.add_to(*cmd);
  cmd->footer("Example: clothbench friction xpbd bullet-soft --substeps 8 32");
  cmd->callback([&console, &a] {
    const Overrides overrides = split_overrides(a.set);
    if (a.solvers.empty())
      for (const SolverEntry& e : solvers())
        if (!(e.info.supports & kColliderFeatures).empty()) a.solvers.push_back(e.info.name);
    Table t{"Friction by closed forms",
            "Errors of the critical angle (Coulomb's cone), of the creep of a sheet that friction holds, and of the "
            "displacements of one that slips and of one that stops. Capstan: errors of the overhang that it holds (a "
            "polygon of as many sides as rows lie on it) and of the displacements over it with and without friction. "
            "✓: within the bound. Thresholds by bisection, 0.1 % of the coefficient.",
            {{"solver", "setting"}}};
    for (const FrictionForm& f : friction_forms()) t.rows[0].emplace_back(f.head);
    nlohmann::json all = nlohmann::json::array();
    Guard guard(console.words);
    std::set<std::string> crashes;
    std::optional<StatusLine> line(!console.json);
    for (const std::string& name : a.solvers) {
      const SolverEntry& entry = find_solver(name);
      std::vector<nlohmann::json> rows = {overrides.solver};
      for (const int n : a.substeps) {
        rows.push_back(overrides.solver);
        rows.back()["substeps"] = n;
      }
      for (const nlohmann::json& given : rows) {
        if (given.contains("substeps") && !complete_settings(entry.info, nlohmann::json::object()).contains("substeps"))
          continue;
        const nlohmann::json settings = complete_settings(entry.info, given);
        const std::string label = Overrides{{}, given}.label();
        std::vector<std::string> row = {name, label};
        nlohmann::json j = {{"solver", name}, {"setting", label}};
        for (const FrictionForm& f : friction_forms()) {
          line->show(fmt::format("{} {}: {}", name, label, f.scene), 0, 0);
          std::string crash;
          j["answers"].push_back(ask_friction(guard, f, entry, settings, overrides.scene, a.device.options, crash));
          row.push_back(j["answers"].back()["text"]);
          if (!crash.empty()) crashes.insert(fmt::format("{} {}: {}: its process: {}", name, label, f.scene, crash));
        }
        t.rows.push_back(std::move(row));
        all.push_back(std::move(j));
      }
    }
    line.reset();
    if (guard.crashed()) console.exit_code = ExitCode::CheckFailed;
    if (console.json)
      fmt::print("{}\n", all.dump(2));
    else
      fmt::print("{}\n", t.console());
    for (const std::string& crash : crashes) fmt::print(stderr, "{}\n", crash);
    if (!a.readme.empty()) write_between_marks(a.readme, "friction", t.markdown());
  });
}

}  // namespace clothbench
