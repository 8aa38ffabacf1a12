#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <set>

#include "base/table.hpp"
#include "cli/again.hpp"
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

/// A column: what of which scene, and what is asked of it.
struct Form {
  const char *scene, *head;
  bool threshold;
  double scale;    ///< to the head's unit
  double at_most;  ///< in the head's unit
};

// Coulomb's cone on a slope, uniform deceleration, Euler and Eytelwein's belt on a polygon, Lagrange's strip over a
// cylinder; harness/truth has them. Bounds: what a solver's author should want.
constexpr Form kForms[] = {{"incline-stick", "critical angle [°], ≤ 0.1", true, 1, 0.1},
                           {"incline-stick", "creep in 2 s [% L], ≤ 0.01", false, 100, 0.01},
                           {"incline-slip", "way down [%], ≤ 2", false, 100, 2},
                           {"incline-stop", "way to stop [%], ≤ 2", false, 100, 2},
                           {"capstan-hold", "overhang held [%], ≤ 3", true, 100, 3},
                           {"capstan-slip", "way round [%], ≤ 3", false, 100, 3},
                           {"atwood", "way of Atwood's strip [%], ≤ 3", false, 100, 3}};

struct Answer {
  double error = std::nan("");  ///< in the form's unit, signed for thresholds
  std::string text;
  std::string crash = {};  ///< of a plugin
};

Answer ask(const Form& form, const SolverEntry& entry, const nlohmann::json& settings,
           const std::vector<std::string>& set, const DeviceOptions& device) {
  const Scene scene = load_scene(std::string("validation/") + form.scene, set);
  if (!unsupported(entry.info, scene.needs).empty()) return {std::nan(""), "unsupported"};
  Answer out;
  std::string bound;
  if (form.threshold) {
    const FoundThreshold t = find_threshold(scene, entry, settings, device);
    out.error = form.scale * t.error;
    bound = t.holds_at_least ? "holds at half of it" : t.slips_at_most ? "slips at 1.5 of it" : "";
  } else {
    out.error = form.scale * end_error(scene, entry, settings, device);
  }
  if (!std::isfinite(out.error)) return {out.error, "failed"};
  out.text = bound.empty() ? fmt::format("{}{:.2g}", form.threshold && out.error > 0 ? "+" : "", out.error) : bound;
  if (bound.empty() && std::abs(out.error) <= form.at_most) out.text += " ✓";
  return out;
}

Answer guarded(Guard& guard, const Form& form, const SolverEntry& entry, const nlohmann::json& settings,
               const std::vector<std::string>& set, const DeviceOptions& device) {
  const Guard::Answer given = guard.run(entry, [&] {
    const Answer a = ask(form, entry, settings, set, device);
    return nlohmann::json{{"error", std::isfinite(a.error) ? nlohmann::json(a.error) : nlohmann::json()},
                          {"text", a.text}};
  });
  if (!given.crash.empty()) return {std::nan(""), "crashed", given.crash};
  return {given.value["error"].is_null() ? std::nan("") : given.value["error"].get<double>(),
          given.value["text"].get<std::string>()};
}

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
            "Error of the critical angle (Coulomb's cone), of how far a sheet creeps that is held, of the ways of one "
            "that slips and of one "
            "that stops, of the overhang that a capstan holds (a polygon of as many sides as rows lie on it) and of "
            "the ways over it with and "
            "without friction. ✓: within the bound. Thresholds by bisection, 0.1 % of the coefficient.",
            {{"solver", "setting"}}};
    for (const Form& f : kForms) t.rows[0].emplace_back(f.head);
    nlohmann::json all = nlohmann::json::array();
    Guard guard(console);
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
        for (const Form& f : kForms) {
          line->show(fmt::format("{} {}: {}", name, label, f.scene), 0, 0);
          const Answer answer = guarded(guard, f, entry, settings, overrides.scene, a.device.options);
          if (!answer.crash.empty())
            crashes.insert(fmt::format("{} {}: {}: its process: {}", name, label, f.scene, answer.crash));
          row.push_back(answer.text);
          j["answers"].push_back(
              {{"scene", f.scene},
               {"what", f.head},
               {"error", std::isfinite(answer.error) ? nlohmann::json(answer.error) : nlohmann::json()},
               {"at_most", f.at_most},
               {"text", answer.text}});
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
