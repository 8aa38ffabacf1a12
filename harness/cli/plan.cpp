#include <fmt/format.h>

#include <cmath>

#include "base/json_number.hpp"
#include "base/tint.hpp"
#include "cli/command.hpp"
#include "runner/again.hpp"
#include "runner/solver_run.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

struct PlanArguments {
  std::vector<std::string> scenes;
  SolverFlags with;
};

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

std::string bytes(const nlohmann::json& b) { return b.is_null() ? "–" : fmt::format("{:.0f}", b.get<double>()); }

std::string joined(const nlohmann::json& words) {
  std::string text;
  for (const auto& w : words) text += (text.empty() ? "" : ", ") + w.get<std::string>();
  return text;
}

void print(const nlohmann::json& p) {
  fmt::print("{} on {}\n  needs: {}\n", p["solver"].get<std::string>(), p["scene"].get<std::string>(),
             joined(p["needs"]));
  if (p["status"] != "ok")
    fmt::print("  {}: {}\n", tinted(tone_of(p["status"].get<std::string>()), p["status"].get<std::string>()),
               p["message"].get<std::string>());
  if (!p["stages"].empty())
    fmt::print("\n  {:<28} {:>10} {:>14} {:>14}  {}\n", "stage, each frame", "dispatches", "read B", "written B",
               "serves");
  for (const auto& s : p["stages"])
    fmt::print("  {:<28} {:>10} {:>14} {:>14}  {}\n", s["name"].get<std::string>(), s["dispatches"].get<int>(),
               bytes(s["read_B"]), bytes(s["write_B"]), joined(s["serves"]));
  if (!p["buffers"].empty()) fmt::print("\n  {:<28} {:>14}\n", "buffer", "bytes");
  for (const auto& b : p["buffers"])
    fmt::print("  {:<28} {:>14}  {}\n", b["name"].get<std::string>(), b["bytes"].get<std::uint64_t>(),
               b["device_local"].get<bool>() ? "device" : "host");
  if (!p["contact_margins"].empty()) fmt::print("\n  {:<28} {:>14}\n", "cloth is held off", "by [m]");
  for (const auto& m : p["contact_margins"])
    fmt::print("  {:<28} {:>14g}\n", m["collider"].get<std::string>(), m["margin_m"].get<double>());
  if (!p["left_out"].empty()) fmt::print("\n  left out\n");
  for (const auto& l : p["left_out"])
    fmt::print("  {:<28} {}\n", l["what"].get<std::string>(), l["why"].get<std::string>());
  fmt::print("\n");
}

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
        const Guard::Answer answer = guard.run(*s.entry, [&] {
          return plan_of(scene, *s.entry,
                         SolverRun({&scene, s.entry, s.settings, s.setting}, a.with.device.options, "plan"));
        });
        all.push_back(answer.crash.empty() ? answer.value
                                           : plan_of(scene, *s.entry, "crashed", "its process: " + answer.crash));
        if (!console.json) print(all.back());
        if (all.back()["status"] == "error" || guard.crashed()) console.exit_code = ExitCode::CheckFailed;
      }
    }
    if (console.json) fmt::print("{}\n", all.dump(2));
  });
}

}  // namespace clothbench
