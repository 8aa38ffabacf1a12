#include <fmt/format.h>

#include "base/json_number.hpp"
#include "base/tint.hpp"
#include "base/words.hpp"
#include "cli/command.hpp"
#include "runner/solver_run.hpp"

namespace clothbench {
namespace {

nlohmann::json names_of(FeatureSet features) {
  nlohmann::json names = nlohmann::json::array();
  features.for_each([&](Feature f) { names.push_back(name_of(f)); });
  return names;
}

/// A plan without stages.
nlohmann::json plan_of(const Scene& scene, const SolverEntry& entry, const std::string& status,
                       const std::string& message) {
  nlohmann::json j = {{"scene", scene.name},
                      {"solver", entry.info.name},
                      {"needs", names_of(scene.needs)},
                      {"status", status},
                      {"message", message}};
  for (const char* list : {"stages", "buffers", "left_out", "contact_margins"}) j[list] = nlohmann::json::array();
  return j;
}

nlohmann::json plan_of(const Scene& scene, const SolverEntry& entry, const SolverRun& run) {
  nlohmann::json j = plan_of(scene, entry, run.outcome().status, run.outcome().message);
  j.update(run.header().plan.is_null() ? nlohmann::json::object() : run.header().plan);
  for (const StagePlan& s : run.plan().stages)
    j["stages"].push_back({{"name", s.name},
                           {"serves", names_of(s.serves)},
                           {"dispatches", s.dispatches},
                           {"read_B", finite_or_null(s.read_B)},
                           {"write_B", finite_or_null(s.write_B)}});
  return j;
}

std::vector<std::string> words(const nlohmann::json& list) { return list; }

std::string bytes(const nlohmann::json& b) { return b.is_null() ? "–" : fmt::format("{:.0f}", b.get<double>()); }

/// What a solver would run for a scene, in a child for a plugin. Without stages if the solver cannot run the scene or
/// its process crashed.
nlohmann::json ask_plan(Guard& guard, const Scene& scene, const ChosenSolver& s, const DeviceOptions& device) {
  const Guard::Answer answer = guard.run(*s.entry, [&] {
    return plan_of(scene, *s.entry, SolverRun({&scene, s.entry, s.settings, s.setting}, device, "plan"));
  });
  return answer.crash.empty() ? answer.value : plan_of(scene, *s.entry, "crashed", "its process: " + answer.crash);
}

std::string plan_text(const nlohmann::json& p) {
  const auto text = [](const nlohmann::json& j) { return j.get<std::string>(); };
  std::string out =
      fmt::format("{} on {}\n  needs: {}\n", text(p["solver"]), text(p["scene"]), joined(words(p["needs"])));
  if (p["status"] != "ok")
    out += fmt::format("  {}: {}\n", tinted(tone_of(text(p["status"])), text(p["status"])), text(p["message"]));
  if (!p["stages"].empty())
    out += fmt::format("\n  {:<28} {:>10} {:>14} {:>14}  {}\n", "stage, each frame", "dispatches", "read B",
                       "written B", "serves");
  for (const auto& s : p["stages"])
    out += fmt::format("  {:<28} {:>10} {:>14} {:>14}  {}\n", text(s["name"]), s["dispatches"].get<int>(),
                       bytes(s["read_B"]), bytes(s["write_B"]), joined(words(s["serves"])));
  if (!p["buffers"].empty()) out += fmt::format("\n  {:<28} {:>14}\n", "buffer", "bytes");
  for (const auto& b : p["buffers"])
    out += fmt::format("  {:<28} {:>14}  {}\n", text(b["name"]), b["bytes"].get<std::uint64_t>(),
                       b["device_local"].get<bool>() ? "device" : "host");
  if (!p["contact_margins"].empty()) out += fmt::format("\n  {:<28} {:>14}\n", "cloth is held off", "by [m]");
  for (const auto& m : p["contact_margins"])
    out += fmt::format("  {:<28} {:>14g}\n", text(m["collider"]), m["margin_m"].get<double>());
  if (!p["left_out"].empty()) out += "\n  left out\n";
  for (const auto& l : p["left_out"])
    out += fmt::format("  {:<28} {}{}\n", text(l["what"]), text(l["why"]),
                       l.contains("no_parameter") ? "; no parameter: " + text(l["no_parameter"]) : "");
  return out + "\n";
}

struct PlanArguments {
  std::vector<std::string> scenes;
  SolverFlags with;
};

}  // namespace

void add_plan(CLI::App& app, Console& console) {
  PlanArguments& a = console.arguments<PlanArguments>();
  CLI::App* cmd = app.add_subcommand(
      "plan", "Print what a solver would run for a scene: kernels, dispatches, buffers, bytes and omitted features");
  cmd->add_option("scene", a.scenes, "Scenario files or names")->required();
  a.with.add_to(*cmd, "--solver", "Solvers; default: all", "Override: cloth.grid=[64,64], solver.substeps=20");
  a.with.device.add_to(*cmd);
  cmd->footer(
      "Examples: clothbench plan paper/gravity --solver paper\n"
      "          clothbench plan paper/desk-flat-low --solver xpbd --set cloth.grid=[64,64] --json");
  cmd->callback([&console, &a] {
    nlohmann::json all = nlohmann::json::array();
    Guard guard(console.words);
    for (const std::string& file : a.scenes) {
      const Scene scene = load_scene(file, split_overrides(a.with.set).scene);
      for (const ChosenSolver& s : a.with.chosen(solver_names())) {
        all.push_back(ask_plan(guard, scene, s, a.with.device.options));
        if (!console.json) fmt::print("{}", plan_text(all.back()));
        if (all.back()["status"] == "error" || guard.crashed()) console.exit_code = ExitCode::CheckFailed;
      }
    }
    if (console.json) console.print(all);
  });
}

}  // namespace clothbench
