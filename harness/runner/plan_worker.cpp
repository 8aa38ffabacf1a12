// Runs in separate processes: sending a plan to a worker, and storing results of runs that end their process.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <exception>
#include <limits>
#include <mutex>
#include <set>
#include <thread>

#include "clothbench/error.hpp"
#include "results/store.hpp"
#include "runner/interrupt.hpp"
#include "runner/study_plan.hpp"
#include "runner/worker.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Calls `with(key, member)` for each rule except rendering. Rules: TrialRules, const or not.
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
  with("agree", r.agree);
  with("pipelined", r.pipelined);
  with("profiled_frames", r.profiled_frames);
  with("window_s", r.window_s);
}

json to_json(const RunPlan& plan) {
  json j = {{"protocol", plan.protocol},
            {"references", plan.references},
            {"apart", plan.apart},
            {"untimed", plan.untimed},
            {"groups", json::array()}};
  each_rule(plan.rules, [&](const char* key, const auto& value) { j["rules"][key] = value; });
  for (const auto& group : plan.groups) {
    json& specs = j["groups"].emplace_back(json::array());
    for (const RunSpec& c : group)
      specs.push_back({{"scenario", json_from(c.scene->json)},
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

/// A plan that owns its scenes.
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

void plan_from_json(const json& j, const SolverLookup& lookup, OwnPlan& own) {
  RunPlan& plan = own.plan;
  j.at("protocol").get_to(plan.protocol);
  j.at("references").get_to(plan.references);
  j.at("apart").get_to(plan.apart);
  j.at("untimed").get_to(plan.untimed);
  each_rule(plan.rules, [&](const char* key, auto& value) {
    const json& v = j.at("rules").at(key);  // JSON has no infinity and stores null
    value = v.is_null() ? std::numeric_limits<std::decay_t<decltype(value)>>::infinity()
                        : v.get<std::decay_t<decltype(value)>>();
  });
  for (const json& group : j.at("groups")) {
    plan.groups.emplace_back();
    for (const json& s : group) {
      RunSpec& spec = plan.groups.back().emplace_back();
      spec.scene = &add_scene(own, s);
      const std::string solver = s.at("solver");
      spec.entry = lookup(solver);
      if (spec.entry == nullptr) spec.entry = plan.add_not_built(solver);
      spec.settings = s.at("settings");
      spec.setting = s.at("setting");
      spec.work = s.at("work");
    }
  }
}

/// The run named in a progress message such as "<run>: trial 2 of 5"; null if it is not in the plan.
const RunSpec* run_of(const RunPlan& plan, const std::string& doing) {
  const std::string name = doing.substr(0, doing.find(": "));
  for (const auto& group : plan.groups)
    for (const RunSpec& c : group)
      if (run_name(c) == name) return &c;
  return nullptr;
}

std::mutex hdf5;  // the library is not thread-safe

/// Writes the result file that a run's ended process did not write, with the finished frames of its untimed pass.
void write_row(const RunSpec& c, const RunPlan& plan, const fs::path& out, const Outcome& outcome) {
  const std::lock_guard lock(hdf5);
  RunWriter writer(out, header_of(*c.scene, c.entry->info.name, c.setting, c.settings, plan.protocol));
  RunRecord r = writer.recovered();
  r.trials.clear();  // no times for a run that did not end
  r.summary.clear();
  r.outcome = outcome;
  writer.finish(outcome, summarise(c, {}, r));
}

/// Sends the plan to the worker. If its process crashes, or makes no frame for `limit_s`, the current run is stored
/// with this outcome and a new process continues with the rest. If the process had executed other plans before, a crash
/// counts only if it recurs in a new process.
RunResult ask(Worker& worker, const RunPlan& plan, const RunOptions& options, const std::string& eye, double limit_s,
              const char* interrupted) {
  json request = {{"plan", to_json(plan)},
                  {"out", options.out.string()},
                  {"device", device_to_json(options.device)},
                  {"eye", eye},
                  {"resume", options.resume},
                  {"reference_cache", options.reference_cache.string()}};
  for (std::size_t process = 0; process <= 2 * plan.size(); ++process) {  // at most two processes per run
    std::string doing = "before the first run";
    const WorkerAnswer answer =
        worker.call("plan", request, 0, interrupted, [&](const std::string& what, std::size_t done, std::size_t total) {
          doing = what;
          if (options.progress) options.progress(what, done, total);
          return run_of(plan, what) != nullptr ? limit_s : 0;
        });
    if (!answer.end) return {{}, answer.value.get<std::vector<std::string>>()};
    request["resume"] = true;
    const bool hung = answer.end->how == ChildEnd::How::TimedOut;
    if (!hung && worker.calls_of_child() > 1) continue;
    const RunSpec* at = run_of(plan, doing);
    if (at == nullptr)
      throw Error(fmt::format("{}: the study's process: {}", doing, answer.end->text()), ExitCode::CheckFailed);
    const std::string message = fmt::format("its process: {}, at \"{}\"{}", answer.end->text(), doing,
                                            answer.last_words.empty() ? "" : "; last output: " + answer.last_words);
    if (!plan.apart) fmt::print(stderr, "{}\n", message);
    write_row(*at, plan, options.out, {hung ? "timed_out" : "crashed", "F3", -1, message});
    if (plan.apart) return {};  // the plan's only run
  }
  throw Error("the study's process crashed more than twice per run", ExitCode::CheckFailed);
}

/// Runs with the most work begin first, so that the other workers do not wait for one long run at the end.
double work_of(const RunSpec& s) {
  return static_cast<double>(s.scene->time.frames()) * static_cast<double>(s.scene->cloth.vertex_count()) *
         s.settings.value("iterations", 1.0) * std::max(1.0, s.settings.value("substeps", 1.0));
}

using Task = std::function<void(Worker&)>;

/// Runs the tasks on options.jobs threads, in order as threads become free; each thread has its own worker. After an
/// exception no further task begins, and the first exception is thrown once all threads have ended.
void run_tasks(const std::vector<Task>& tasks, const RunOptions& options) {
  // Processes of one study (--job) share its folder, so scratch files are not in it.
  const fs::path scratch = fs::temp_directory_path() / fmt::format("clothbench-workers-{}", getpid());
  std::atomic<std::size_t> next{0};
  std::exception_ptr first;
  std::mutex mutex;
  const auto work = [&](int k) {
    try {
      Worker worker(options.program, scratch / std::to_string(k));
      for (std::size_t task = next++; task < tasks.size(); task = next++) tasks[task](worker);
    } catch (...) {
      next = tasks.size();
      const std::lock_guard lock(mutex);
      if (!first) first = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  for (int k = 1; k < std::min<int>(options.jobs, static_cast<int>(tasks.size())); ++k) threads.emplace_back(work, k);
  work(0);
  for (std::thread& t : threads) t.join();
  if (first) std::rethrow_exception(first);
  std::error_code ignored;
  fs::remove_all(scratch, ignored);
}

/// The untimed passes of all runs. Passes of one solver's settings sweep in one group form one task and keep their
/// order, because the sweep ends at its first timeout.
void execute_untimed(const RunPlan& plan, const RunOptions& given) {
  std::mutex mutex;
  RunOptions options = given;
  options.progress = [&](const std::string& what, std::size_t, std::size_t) {
    const std::lock_guard lock(mutex);
    if (given.progress && !what.empty()) given.progress(what, 0, plan.size());
  };
  auto groups = plan.groups;
  std::stable_sort(groups.begin(), groups.end(), [](auto& a, auto& b) { return work_of(a[0]) > work_of(b[0]); });
  std::vector<Task> tasks;
  std::set<std::string> solved;  // scenes whose solution one task computes, beside the passes of the other scenes
  for (const auto& group : groups) {
    std::map<std::pair<std::string, std::string>, std::vector<RunSpec>> sweeps;
    for (const RunSpec& spec : group)
      sweeps[{spec.entry->info.name, spec.work > 0 ? "" : spec.setting}].push_back(spec);
    for (auto& [unused, specs] : sweeps)
      tasks.push_back([&, first = solved.insert(specs[0].scene->sha256).second, specs = specs](Worker& worker) {
        stop_if_interrupted(kTrialsKept);
        RunPlan part;
        part.references = plan.references && first;
        part.groups = {specs};
        part.rules = plan.rules;
        part.protocol = plan.protocol;
        part.untimed = true;
        ask(worker, part, options, "", solver_limit_s(), kTrialsKept);
      });
  }
  run_tasks(tasks, options);
}

/// Runs each run in its own worker process, `jobs` at a time.
RunResult execute_apart(const RunPlan& plan, const RunOptions& options) {
  std::size_t done = 0;
  const auto ended = [&](const RunSpec& spec) {
    if (options.progress) options.progress(run_name(spec), ++done, plan.size());
  };
  std::vector<const RunSpec*> todo;
  for (const auto& group : plan.groups)
    for (const RunSpec& spec : group)
      if (finished_run(spec, options))
        ended(spec);
      else
        todo.push_back(&spec);
  std::stable_sort(todo.begin(), todo.end(), [](auto* a, auto* b) { return work_of(*a) > work_of(*b); });
  std::mutex mutex;
  std::vector<Task> tasks;
  for (const RunSpec* spec : todo)
    tasks.push_back([&, spec](Worker& worker) {
      stop_if_interrupted(kRunsKept);
      run_apart(worker, plan, *spec, options);
      const std::lock_guard lock(mutex);
      ended(*spec);
    });
  run_tasks(tasks, options);
  return {};
}

}  // namespace

RunRecord run_apart(Worker& worker, const RunPlan& plan, const RunSpec& spec, const RunOptions& given) {
  RunPlan one;
  one.groups = {{spec}};
  one.rules = plan.rules;
  one.protocol = plan.protocol;
  one.apart = true;
  RunOptions options = given;
  options.resume = true;
  options.progress = nullptr;
  const double limit_s = plan.rules.run_limit_s;
  ask(worker, one, options, "", limit_s > 0 ? 1.2 * limit_s + 5 : solver_limit_s(), kRunsKept);
  const std::lock_guard lock(hdf5);
  RunRecord r = read_run_summary(finished_file(options.out, run_name(spec)));
  const std::string& status = r.outcome.status;
  if (status == "error" || status == "device_lost" || status == "timed_out") worker.replace_child();
  return r;
}

RunResult execute_in_worker(const RunPlan& plan, const RunOptions& options, const std::string& eye) {
  if (plan.apart) return execute_apart(plan, options);
  RunOptions timed = options;
  timed.resume = options.resume || options.jobs > 1;
  if (options.jobs > 1) execute_untimed(plan, options);
  Worker worker(options.program);
  return ask(worker, plan, timed, eye, solver_limit_s(), kTrialsKept);
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
  // The parent ends a process that reports nothing for too long. The repeated reports show that a slow solver still
  // completes frames.
  const FrameReports reports([&] {
    if (repeat) repeat();
  });
  try {
    return execute_runs(own.plan, options).faults;
  } catch (const std::exception& e) {  // an exception of a solver becomes a row of the table
    if (!own.plan.apart) throw;
    write_row(own.plan.groups[0][0], own.plan, options.out, {"error", "F3", -1, e.what()});
    return json::array();
  }
}

}  // namespace clothbench
