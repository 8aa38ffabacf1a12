#include <fmt/format.h>

#include <cmath>
#include <deque>
#include <limits>

#include "base/plugin_environment.hpp"
#include "clothbench/error.hpp"
#include "results/store.hpp"
#include "runner/interrupt.hpp"
#include "runner/study_plan.hpp"
#include "runner/worker.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

/// Calls `with(key, member)` for each rule but the rendering. Rules: TrialRules, const or not.
template <class Rules, class With>
void each_rule(Rules& r, With with) {
  with("trials", r.trials);
  with("frames", r.frames);
  with("max_wall_s", r.max_wall_s);
  with("min_frames", r.min_frames);
  with("warmup_s", r.warmup_s);
  with("drop_frames", r.drop_frames);
  with("accuracy_duration_s", r.accuracy_duration_s);
  with("run_limit_s", r.run_limit_s);
  with("ladder_limit_s", r.ladder_limit_s);
  with("agree", r.agree);
  with("pipelined", r.pipelined);
  with("profiled_frames", r.profiled_frames);
}

json to_json(const RunPlan& plan) {
  json j = {{"protocol", plan.protocol}, {"references", plan.references}, {"groups", json::array()}};
  each_rule(plan.rules, [&](const char* key, const auto& value) { j["rules"][key] = value; });
  for (const auto& group : plan.groups) {
    json& specs = j["groups"].emplace_back(json::array());
    for (const RunSpec& c : group)
      specs.push_back({{"scenario", json::parse(c.scene->json)},
                       {"source", c.scene->source},
                       {"name", c.scene->name},
                       {"sha256", c.scene->sha256},
                       {"solver", c.entry->info.name},
                       {"settings", c.settings},
                       {"setting", c.setting},
                       {"work", c.work}});
  }
  return j;
}

/// A plan with its scenes.
struct OwnPlan {
  RunPlan plan;
  std::deque<Scene> scenes;
};

const Scene& add_scene(OwnPlan& own, const json& spec) {
  Scene scene = scene_from_json(spec.at("scenario"), spec.at("source"));
  scene.name = spec.at("name");
  if (scene.sha256 != spec.at("sha256").get<std::string>())
    throw Error(scene.source + ": the scene of " + scene.name + " differs in another process", ExitCode::CheckFailed);
  return own.scenes.emplace_back(std::move(scene));
}

const SolverEntry* add_entry(RunPlan& plan, const std::string& name, const SolverLookup& lookup) {
  if (const SolverEntry* e = lookup(name)) return e;
  auto absent = std::make_shared<SolverEntry>();
  absent->info.name = name;
  plan.not_built.push_back(absent);
  return absent.get();
}

void plan_from_json(const json& j, const SolverLookup& lookup, OwnPlan& own) {
  RunPlan& plan = own.plan;
  j.at("protocol").get_to(plan.protocol);
  j.at("references").get_to(plan.references);
  each_rule(plan.rules, [&](const char* key, auto& value) {
    const json& v = j.at("rules").at(key);  // null: infinite
    value = v.is_null() ? std::numeric_limits<std::decay_t<decltype(value)>>::infinity()
                        : v.get<std::decay_t<decltype(value)>>();
  });
  for (const json& group : j.at("groups")) {
    plan.groups.emplace_back();
    for (const json& s : group) {
      RunSpec& spec = plan.groups.back().emplace_back();
      spec.scene = &add_scene(own, s);
      spec.entry = add_entry(plan, s.at("solver"), lookup);
      spec.settings = s.at("settings");
      spec.setting = s.at("setting");
      spec.work = s.at("work");
    }
  }
}

json to_json(const RunResult& r) {
  return {{"ok", r.runs_ok},
          {"unsupported", r.runs_unsupported},
          {"over_budget", r.runs_over_budget},
          {"failed", r.runs_failed},
          {"seconds", r.seconds},
          {"faults", r.faults}};
}

RunResult result_from_json(const json& j) {
  RunResult r;
  j.at("ok").get_to(r.runs_ok);
  j.at("unsupported").get_to(r.runs_unsupported);
  j.at("over_budget").get_to(r.runs_over_budget);
  j.at("failed").get_to(r.runs_failed);
  j.at("seconds").get_to(r.seconds);
  j.at("faults").get_to(r.faults);
  return r;
}

/// "<run>: trial 2 of 5" -> that run; null if it is not the plan's.
const RunSpec* run_of(const RunPlan& plan, const std::string& doing) {
  const std::string name = doing.substr(0, doing.find(": "));
  for (const auto& group : plan.groups)
    for (const RunSpec& c : group)
      if (run_name(c) == name) return &c;
  return nullptr;
}

void write_row(const RunSpec& c, const RunPlan& plan, const std::filesystem::path& out, const Outcome& outcome) {
  RunRecord r;
  r.header = header_of(*c.scene, c.entry->info.name, c.setting, c.settings, plan.protocol);
  r.outcome = outcome;
  write_failed_run(out, r.header, outcome, summarise(c, {}, r));
}

}  // namespace

bool runs_in_worker(const RunPlan& plan) { return !plan.apart && !solvers_in_process(); }

RunResult execute_in_worker(const RunPlan& plan, const RunOptions& options, const std::string& eye) {
  json request = {{"plan", to_json(plan)},
                  {"out", options.out.string()},
                  {"device", device_to_json(options.device)},
                  {"eye", eye},
                  {"resume", options.resume},
                  {"reference_cache", options.reference_cache.string()}};
  Worker worker(options.program);
  for (std::size_t process = 0; process <= plan.size(); ++process) {  // one row per process at least
    std::string doing = "before the first run";
    const WorkerAnswer answer =
        worker.call("plan", request, 0, kTrialsKept, [&](const std::string& what, std::size_t done, std::size_t total) {
          doing = what;
          if (options.progress) options.progress(what, done, total);
          return run_of(plan, what) != nullptr ? solver_limit_s() : 0;
        });
    if (!answer.end) return result_from_json(answer.value);
    const RunSpec* at = run_of(plan, doing);
    if (at == nullptr)
      throw Error(fmt::format("{}: the study's process: {}", doing, answer.end->text()), ExitCode::CheckFailed);
    const std::string message = fmt::format("its process: {}, at \"{}\"", answer.end->text(), doing);
    fmt::print(stderr, "{}\n", message);
    write_row(*at, plan, options.out,
              {answer.end->how == ChildEnd::How::TimedOut ? "timed_out" : "crashed", "F3", -1, message});
    request["resume"] = true;
  }
  throw Error("the study's process crashed more often than there are runs", ExitCode::CheckFailed);
}

json execute_plan(const json& request, const WorkerProgress& progress, const SolverLookup& lookup,
                  Rendering (*rendering_of)(const std::string& eye)) {
  OwnPlan own;
  plan_from_json(request.at("plan"), lookup, own);
  if (const std::string eye = request.at("eye"); !eye.empty()) own.plan.rules.rendering = rendering_of(eye);
  RunOptions options;
  options.out = request.at("out").get<std::string>();
  options.resume = request.at("resume");
  options.device = device_from_json(request.at("device"));
  options.reference_cache = request.at("reference_cache").get<std::string>();
  std::function<void()> repeat;
  options.progress = [&](const std::string& what, std::size_t done, std::size_t total) {
    progress(what, done, total);
    repeat = [=, &progress] { progress(what, done, total); };
  };
  // The parent ends a process that says nothing for too long: a solver that makes frames is not taken for one that
  // hangs.
  const FrameReports reports([&] {
    if (repeat) repeat();
  });
  return to_json(execute_runs(own.plan, options));
}

}  // namespace clothbench
