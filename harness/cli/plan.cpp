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
  std::vector<std::string> scenes, solvers, set;
  DeviceFlags device;
};

nlohmann::json plan_of(const SolverRun& run, const Scene& scene) {
  nlohmann::json needs = nlohmann::json::array(), stages = nlohmann::json::array();
  scene.needs.for_each([&](Feature f) { needs.push_back(name_of(f)); });
  for (const StagePlan& s : run.plan().stages) {
    nlohmann::json serves = nlohmann::json::array();
    s.serves.for_each([&](Feature f) { serves.push_back(name_of(f)); });
    stages.push_back({{"name", s.name},
                      {"serves", serves},
                      {"dispatches", s.dispatches},
                      {"read_B", finite_or_null(s.read_B)},
                      {"write_B", finite_or_null(s.write_B)}});
  }
  nlohmann::json j = {{"scene", scene.name},
                      {"solver", run.header().solver},
                      {"needs", needs},
                      {"status", run.outcome().status},
                      {"message", run.outcome().message},
                      {"stages", stages},
                      {"buffers", nlohmann::json::array()},
                      {"left_out", nlohmann::json::array()},
                      {"contact_margins", nlohmann::json::array()}};
  for (const char* key : {"buffers", "left_out", "contact_margins"})
    if (run.header().plan.contains(key)) j[key] = run.header().plan[key];
  return j;
}

nlohmann::json crashed_plan(const Scene& scene, const SolverEntry& entry, const std::string& how) {
  nlohmann::json needs = nlohmann::json::array();
  scene.needs.for_each([&](Feature f) { needs.push_back(name_of(f)); });
  nlohmann::json j = {{"scene", scene.name},
                      {"solver", entry.info.name},
                      {"needs", needs},
                      {"status", "crashed"},
                      {"message", "its process: " + how}};
  for (const char* none : {"stages", "buffers", "left_out", "contact_margins"}) j[none] = nlohmann::json::array();
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
      "plan", "What a solver would run for a scene: kernels, dispatches, buffers, bytes, and what it leaves out");
  cmd->add_option("scene", a.scenes, "Scenario files or names")->required();
  add_solvers(*cmd, "--solver", a.solvers, "Solvers; default: all");
  cmd->add_option("--set", a.set, "Override: cloth.grid=[64,64], solver.substeps=20");
  a.device.add_to(*cmd);
  cmd->footer(
      "Examples: clothbench plan paper/gravity --solver paper\n"
      "          clothbench plan paper/desk-flat-low --solver xpbd --set cloth.grid=[64,64] --json");
  cmd->callback([&console, &a] {
    const Overrides overrides = split_overrides(a.set);
    if (a.solvers.empty())
      for (const SolverEntry& e : solvers()) a.solvers.push_back(e.info.name);
    nlohmann::json all = nlohmann::json::array();
    Guard guard(console.words);
    for (const std::string& file : a.scenes) {
      const Scene scene = load_scene(file, overrides.scene);
      for (const std::string& name : a.solvers) {
        const SolverEntry& entry = find_solver(name);
        const Guard::Answer answer = guard.run(entry, [&] {
          return plan_of(SolverRun({&scene, &entry, complete_settings(entry.info, overrides.solver), overrides.label()},
                                   a.device.options, "plan"),
                         scene);
        });
        all.push_back(answer.crash.empty() ? answer.value : crashed_plan(scene, entry, answer.crash));
        if (!console.json) print(all.back());
        if (all.back()["status"] == "error" || guard.crashed()) console.exit_code = ExitCode::CheckFailed;
      }
    }
    if (console.json) fmt::print("{}\n", all.dump(2));
  });
}

}  // namespace clothbench
