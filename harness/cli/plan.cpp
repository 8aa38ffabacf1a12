#include <fmt/format.h>

#include "base/table.hpp"
#include "base/words.hpp"
#include "cli/command.hpp"
#include "runner/conformance.hpp"
#include "runner/study_plan.hpp"
#include "runner/worker.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

json names_of(FeatureSet features) {
  json names = json::array();
  features.for_each([&](Feature f) { names.push_back(name_of(f)); });
  return names;
}

/// A plan without stages.
json plan_of(const Scene& scene, const SolverEntry& entry, const std::string& status, const std::string& message) {
  json j = {{"scene", scene.name},
            {"solver", entry.info.name},
            {"needs", names_of(scene.needs)},
            {"status", status},
            {"message", message}};
  for (const char* list : {"stages", "buffers", "left_out", "contact_margins"}) j[list] = json::array();
  return j;
}

json plan_of(const Scene& scene, const SolverEntry& entry, const SolverRun& run) {
  json j = plan_of(scene, entry, run.outcome().status, run.outcome().message);
  j.update(run.header().plan.is_null() ? json::object() : run.header().plan);
  for (const StagePlan& s : run.plan().stages)
    j["stages"].push_back({{"name", s.name},
                           {"serves", names_of(s.serves)},
                           {"dispatches", s.dispatches},
                           {"read_B", finite_or_null(s.read_B)},
                           {"write_B", finite_or_null(s.write_B)}});
  return j;
}

std::vector<std::string> words(const json& list) { return list; }

std::string bytes(const json& b) { return b.is_null() ? "–" : fmt::format("{:.0f}", b.get<double>()); }

/// The plan of a solver for a scene: `clothbench plan` in the worker.
json plan_answer(const json& request) {
  const SolverEntry& entry = find_solver(request.at("solver"));
  const Scene scene = load_scene(request.at("scene"), request.at("set").get<std::vector<std::string>>());
  const RunSpec spec{&scene, &entry, request.at("settings"), request.at("setting")};
  return plan_of(scene, entry, SolverRun(spec, device_from_json(request.at("device")), "plan"));
}

std::string plan_text(const json& p) {
  const auto text = [](const json& j) { return j.get<std::string>(); };
  const std::size_t columns = console_columns();
  std::string out = fmt::format("{} on {}\n", text(p["solver"]), text(p["scene"]));
  out += wrapped(joined(words(p["needs"])), 9, columns, "  needs:");
  if (p["status"] != "ok") out += wrapped(text(p["status"]) + ": " + text(p["message"]), 2, columns);
  const auto add = [&](const char* title, const char* list, std::vector<std::string> head, auto&& row) {
    Table t{title, "", {std::move(head)}};
    for (const json& entry : p[list]) t.rows.push_back(row(entry));
    if (t.rows.size() > 1) out += t.console();
  };
  if (p.contains("substeps")) out += fmt::format("  substeps per frame, at most: {}\n", p["substeps"].get<int>());
  using Cells = std::vector<std::string>;
  add("Each frame", "stages", {"stage", "dispatches", "read B", "written B", "serves"}, [&](const json& s) {
    return Cells{text(s["name"]), dump(s["dispatches"]), bytes(s["read_B"]), bytes(s["write_B"]),
                 joined(words(s["serves"]))};
  });
  add("Buffers", "buffers", {"buffer", "bytes", "memory"}, [&](const json& b) {
    return Cells{text(b["name"]), dump(b["bytes"]), b["device_local"].get<bool>() ? "device" : "host"};
  });
  add("Contact offsets", "contact_margins", {"collider", "offset [m]"}, [&](const json& m) {
    return Cells{text(m["collider"]), fmt::format("{:g}", m["margin_m"].get<double>())};
  });
  if (!p["left_out"].empty()) out += "\nDisabled features\n";
  for (const auto& l : p["left_out"]) {
    const char* loss = l.contains("no_parameter") ? "; without it the cloth is not as stiff as the scene states" : "";
    out += wrapped(text(l["why"]) + loss, 30, columns, "  " + text(l["what"]));
  }
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
      "plan",
      "Print how a solver simulates one frame of a scene: stages, dispatches, buffers, bytes and disabled features");
  cmd->add_option("scene", a.scenes, "Scene files or names")->required();
  a.with.add_to(*cmd, "--solver", "Solvers; default: all", "Override: cloth.grid=[64,64], solver.substeps=20");
  a.with.device.add_to(*cmd);
  cmd->footer(
      "Examples: clothbench plan paper/gravity --solver paper\n"
      "          clothbench plan paper/desk-flat-low --solver xpbd --set cloth.grid=[64,64] --json");
  cmd->callback([&console, &a] {
    json all = json::array();
    Worker worker;
    for (const std::string& file : a.scenes) {
      const std::vector<std::string> set = split_overrides(a.with.set).scene;
      const Scene scene = load_scene(file, set);
      for (const ChosenSolver& s : a.with.chosen(solver_names())) {
        const json request = {
            {"scene", file},          {"set", set},           {"solver", s.entry->info.name},
            {"settings", s.settings}, {"setting", s.setting}, {"device", device_to_json(a.with.device.options)}};
        const WorkerAnswer answer = guarded(worker, "plan-of-solver", request, plan_answer);
        all.push_back(answer.end ? plan_of(scene, *s.entry, "crashed", "its process: " + answer.end->text())
                                 : answer.value);
        if (!console.json) fmt::print("{}", plan_text(all.back()));
        if (all.back()["status"] == "error" || all.back()["status"] == "crashed")
          console.exit_code = ExitCode::CheckFailed;
      }
    }
    if (console.json) console.print(all);
  });
}

void add_run_child(CLI::App& app, Console& console) {
  CLI::App* cmd = app.add_subcommand("run-child", "Execute what another process of this program asks for");
  cmd->group("");  // hidden from the help text
  cmd->callback([&console] {
    const auto silent = [](json (*work)(const json&)) {
      return [work](const json& request, const WorkerProgress&) { return work(request); };
    };
    const auto plan = [](const json& request, const WorkerProgress& progress) {
      return execute_plan(request, progress, known_solver, rendering_of);
    };
    console.exit_code = static_cast<ExitCode>(run_child_main(
        {{"plan", plan}, {"plan-of-solver", silent(plan_answer)}, {"conformance", silent(conformance_answer)}}));
  });
}

}  // namespace clothbench
