#include "runner/stability_study.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "results/store.hpp"
#include "runner/interrupt.hpp"
#include "runner/resume.hpp"
#include "runner/study_plan.hpp"
#include "runner/worker_pool.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A run that is not there yet.
RunRequest request_of(const Study& study, const Study::Item& item, const StudySolver& s, const StabilityOptions& o) {
  RunRequest r;
  r.scenario = json::parse(item.scene.json);
  r.source = item.scene.source;
  r.name = item.scene.name;
  r.solver = s.solver;
  r.setting = s.label;
  r.settings = s.settings;
  r.rules = {o.device, protocol_name(study.length), o.out, study.run_limit_s};
  return r;
}

PlannedRun planned(const Study::Item& item, const StudySolver& s) {
  const SolverEntry* entry = known_solver(s.solver);
  return {run_name(item.scene.name, s.solver, s.label), item.scene.sha256, s.settings,
          entry != nullptr ? &entry->info : nullptr};
}

}  // namespace

void require_same_runs(const Study& study, const StabilityOptions& o) {
  std::vector<PlannedRun> runs;
  for (const Study::Item& item : study.scenes)
    for (const std::size_t k : item.solvers) runs.push_back(planned(item, study.solvers[k]));
  require_same_runs(o.out, runs, o.resume);
}

double grade_of(const RunRecord& a) {
  const auto at = a.summary.find("stability_grade");
  return at != a.summary.end() && std::isfinite(at->second) ? at->second
         : a.outcome.status == "unsupported"                ? kMissing
                                                            : 2;
}

void StabilityCounts::add(const RunRecord& a) {
  const double grade = grade_of(a);
  if (a.outcome.status == "unsupported")
    ++unsupported;
  else if (grade == 0)
    ++stable;
  else if (grade == 1)
    ++degraded;
  else
    ++failed;
  if (a.outcome.status == "crashed" || a.outcome.message.starts_with("its process")) ++crashed;
}

StabilityCounts execute_stability_runs(const Study& study, const StabilityOptions& o) {
  StabilityCounts counts;
  execute_runs_apart(study, o, [&](const StudySolver& s, const RunRecord& a) {
    counts.add(a);
    counts.ends.add(s.solver, a.outcome);
  });
  return counts;
}

void execute_runs_apart(const Study& study, const StabilityOptions& o,
                        const std::function<void(const StudySolver&, const RunRecord&)>& ended) {
  struct Todo {
    const Study::Item* item;
    const StudySolver* solver;
    double work;
  };
  std::vector<Todo> todo;
  std::size_t all = 0;
  for (const Study::Item& item : study.scenes)
    for (const std::size_t k : item.solvers) {
      const StudySolver& s = study.solvers[k];
      ++all;
      const PlannedRun run = planned(item, s);
      if (!run_finished(o.out, run.name)) {
        todo.push_back(
            {&item, &s,
             static_cast<double>(item.scene.time.frames()) * static_cast<double>(item.scene.cloth.vertex_count())});
        continue;
      }
      if (!o.resume) refuse_finished_run(o.out, run.name);
      require_same_run(o.out, run);
      const RunRecord before = read_run_summary(stored_run(o.out, run.name));
      ended(s, before);
    }
  // The longest first, or the last of them is waited for alone.
  std::stable_sort(todo.begin(), todo.end(), [](const Todo& a, const Todo& b) { return a.work > b.work; });
  std::size_t done = all - todo.size();
  std::mutex mutex;
  std::vector<std::function<void(RunWorker&)>> tasks;
  for (const Todo& t : todo)
    tasks.push_back([&, t](RunWorker& worker) {
      stop_if_interrupted(kRunsKept);
      const RunRecord a = worker.run(request_of(study, *t.item, *t.solver, o));
      const std::lock_guard lock(mutex);
      ended(*t.solver, a);
      ++done;
      if (o.progress) o.progress(t.item->scene.name + " with " + t.solver->name(), done, all);
    });
  run_tasks(tasks, o.jobs, o.program, o.out / "scratch");
  std::error_code ignored;
  fs::remove_all(o.out / "scratch", ignored);
}

}  // namespace clothbench
