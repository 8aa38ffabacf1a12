#include "runner/study_runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "metrics/collider_contact.hpp"
#include "metrics/registry.hpp"
#include "metrics/truth_errors.hpp"
#include "results/store.hpp"
#include "runner/environment.hpp"
#include "runner/interrupt.hpp"
#include "runner/reference.hpp"

namespace clothbench {
namespace {

using Clock = std::chrono::steady_clock;

/// One run with its open result file.
struct Running {
  std::unique_ptr<SolverRun> run;
  std::unique_ptr<RunWriter> writer;
  RunRecord record;
  double untimed_s = 0;  ///< wall time of load and untimed pass

  bool has_trial(int k) const {
    for (const TimedTrial& t : record.trials)
      if (t.index == k) return true;
    return false;
  }
  /// Half-range of the trials' frame rates over their median, as in the summary.
  bool trials_agree(double to) const {
    std::vector<double> rates;
    for (const TimedTrial& t : record.trials) {
      double wall_s = 0;
      for (const double w : t.frame_wall_s) wall_s += w;
      rates.push_back(t.frames() / wall_s);
    }
    if (!(to > 0) || rates.size() < 2) return false;
    std::sort(rates.begin(), rates.end());
    return (rates.back() - rates.front()) / 2 <= to * (rates[(rates.size() - 1) / 2] + rates[rates.size() / 2]) / 2;
  }
  int frames() const { return record.trials.empty() ? 0 : record.trials.front().frames(); }
  std::string name() const { return run_name(run->header()); }
};

class GroupRun {
 public:
  GroupRun(const RunPlan& plan, const RunOptions& options, RunResult& result, std::size_t& done)
      : plan_(plan), options_(options), result_(result), done_(done) {}

  void run(const std::vector<RunSpec>& group) {
    running_.reserve(group.size());
    for (const RunSpec& spec : group) {
      begin(spec);
      if (plan_.untimed) running_.clear();
    }
    for (int k = 0; k < plan_.rules.trials; ++k) round(k);
    for (Running& r : running_) finish(r);
  }

 private:
  /// One trial of every run: first all GPU runs, then all CPU runs. Each round starts with a different run, so that no
  /// run always follows the same neighbour. A GPU goes to sleep during CPU runs, and waking it takes longer than the
  /// warm-up of a small run. Therefore the first GPU run of each round gets a longer warm-up.
  void round(int k) {
    constexpr double kWakeUp = 5;  // normal warm-ups
    for (const bool on_gpu : {true, false}) {
      std::vector<Running*> part;
      for (Running& r : running_)
        if (r.run->alive() && r.run->spec().entry->info.on_gpu == on_gpu && !r.has_trial(k) &&
            !r.trials_agree(plan_.rules.agree))
          part.push_back(&r);
      for (std::size_t i = 0; i < part.size(); ++i) {
        TrialRules rules = plan_.rules;
        if (on_gpu && i == 0) rules.warmup_s *= kWakeUp;
        trial(*part[(i + static_cast<std::size_t>(k)) % part.size()], k, rules);
      }
    }
  }

  void note(const std::string& what) const {
    if (options_.progress) options_.progress(what, done_, plan_.size());
  }

  /// Reason to skip a run of a settings sweep: a setting with less work has timed out. Empty if none has.
  std::string over_budget(const RunSpec& spec) const {
    const auto at = timed_out_work_.find(spec.entry->info.name);
    if (at == timed_out_work_.end() || spec.work <= at->second) return "";
    return fmt::format("not run: {} times the work of a setting that timed out", spec.work / at->second);
  }
  void note_end(const RunSpec& spec, const std::string& status) {
    if (spec.work == 0 || status != "timed_out") return;
    int& work = timed_out_work_.try_emplace(spec.entry->info.name, spec.work).first->second;
    work = std::min(work, spec.work);
  }

  /// Loads the solver and runs the untimed pass.
  void begin(const RunSpec& given) {
    const Clock::time_point start = Clock::now();
    RunSpec spec = given;
    const std::string name = run_name(spec);
    if (options_.resume) remove_leftovers(options_.out, name);
    if (const auto before = finished_run(spec, options_)) {
      note_end(spec, before->outcome.status);
      ++done_;
      return;
    }
    spec.over_budget = over_budget(spec);
    open(spec, name);
    Running& r = running_.back();
    if (r.run->alive() && r.untimed_s == 0) accuracy(r, start);
    note_end(spec, r.run->outcome().status);
  }

  void open(const RunSpec& spec, const std::string& name) {
    note(name + ": load");
    Running r;
    r.run = std::make_unique<SolverRun>(spec, options_.device, plan_.protocol);
    r.run->describe(plan_.rules);
    r.record.header = r.run->header();
    r.writer = std::make_unique<RunWriter>(options_.out, r.run->header());
    if (options_.resume) {
      const RunRecord before = r.writer->recovered();
      for (const TimedTrial& t : before.trials)  // a trial without the requested rendering is repeated
        if (!plan_.rules.rendering.make || !t.frame_rendered_s.empty()) r.record.trials.push_back(t);
      if (r.run->alive() && r.run->take_over(before, plan_.rules.accuracy_duration_s)) {
        r.record.accuracy = before.accuracy;
        r.record.outcome = before.outcome;
        r.record.summary = before.summary;
        r.untimed_s = before.summary.at(kUntimed);
      }
    }
    if (r.run->alive()) r.writer->write_replay(replay_of(*spec.scene));
    running_.push_back(std::move(r));
  }

  void accuracy(Running& r, Clock::time_point start) {
    note(r.name() + ": accuracy");
    r.record.accuracy =
        r.run->run_accuracy(plan_.rules, [&](const AccuracyPass& so_far) { r.writer->write_frames(so_far); });
    r.untimed_s = std::chrono::duration<double>(Clock::now() - start).count();
    std::map<std::string, double> summary = {{kUntimed, r.untimed_s}};
    r.record.outcome = outcome_of(r);
    // Only these processes run side by side; the one with the trials copies what is known.
    if (plan_.untimed) summary.merge(summarise(r.run->spec(), r.run->plan(), r.record));
    r.writer->write_accuracy(r.record.accuracy, r.record.outcome, summary);
  }

  static Outcome outcome_of(const Running& r) {
    const int messages = r.run->validation_messages();
    if (messages == 0) return r.run->outcome();
    return {"error", "ok", -1, fmt::format("{} validation messages", messages)};
  }

  void trial(Running& r, int k, const TrialRules& rules) {
    note(fmt::format("{}: trial {} of {}", r.name(), k + 1, plan_.rules.trials));
    const std::string gpu = uuid_of_gpu(r.run->header().environment);
    TimedTrial t;
    int before = 0;
    do {
      before = times_held();
      const PowerMeter power("/", gpu);
      t = r.run->run_trial(k, rules, r.frames());
      t.power_W = power.mean_W();
      t.gpu_power_W = power.mean_gpu_W();
    } while (times_held() != before && r.run->alive());
    store_sensors(read_sensors("/", gpu), t);  // before the device cools down
    if (t.frames() == 0) return;
    r.writer->write_trial(t);
    r.record.trials.push_back(std::move(t));
  }

  void finish(Running& r) {
    Outcome outcome = outcome_of(r);
    if (outcome.status == "error" && outcome.klass != "F3") result_.faults.push_back(r.name() + ": " + outcome.message);
    if (outcome.status != r.record.outcome.status) r.record.summary.clear();  // ended by a trial
    r.record.outcome = outcome;
    std::map<std::string, double> summary = summarise(r.run->spec(), r.run->plan(), r.record);
    TimedTrial start;
    store_sensors(r.record.header.environment.value("sensors", nlohmann::json::object()), start);
    summarise_sensors(start, "start", summary);
    summarise_sensors(r.record.trials.empty() ? TimedTrial{} : r.record.trials.back(), "end", summary);
    summary[kUntimed] = r.untimed_s;
    Judgement verdict = judge(*r.run->spec().scene, outcome, r.record.accuracy, summary);
    outcome.expect = std::move(verdict.text);
    summary.merge(verdict.scalars);
    result_.files.push_back(r.writer->finish(outcome, summary));
    ++done_;
  }

  const RunPlan& plan_;
  const RunOptions& options_;
  RunResult& result_;
  std::size_t& done_;
  std::map<std::string, int> timed_out_work_;  ///< minimum work that timed out, by solver
  std::vector<Running> running_;
};

bool measured(const Scene& scene, const Outcome& outcome, const AccuracyPass& pass) {
  if (outcome.status == "unsupported" || outcome.status == "over_budget" || outcome.status == "error") return false;
  if (!kWithContactMetrics && !scene.colliders.empty()) return false;
  return outcome.status != "ok" || pass.time_s.size() == static_cast<std::size_t>(scene.time.frames()) + 1;
}

double value_of(const std::map<std::string, double>& summary, const std::string& name) {
  const auto at = summary.find(name);
  return at == summary.end() ? kMissing : at->second;
}

/// Bounds that the scene's file states, and those that follow from the scene: the bounds of its exact solution, and
/// stability grade 0 (no judged outcome class).
std::vector<Expectation> expectations(const Scene& scene, const std::map<std::string, double>& summary) {
  std::vector<Expectation> all = scene.expect;
  if (!scene.reference_case.empty())
    for (const char* scalar : kExactlyBounded) all.push_back({scalar, {}, value_of(summary, scalar + kBound)});
  if (!scene.stability.name.empty()) all.push_back({"stability_grade", {}, 0});
  return all;
}

std::string expected_outcome(const Scene& scene) {
  const bool implied = !scene.reference_case.empty() || !scene.stability.name.empty();
  return scene.expected_outcome.empty() && implied ? "ok" : scene.expected_outcome;
}

/// How a value violates its bound; empty if it does not.
std::string fault(const Expectation& e, double value) {
  if (!std::isfinite(value)) return e.name + " has no value";
  if (e.at_most && !(value <= *e.at_most)) return fmt::format("{} {:.4g} > {:.4g}", e.name, value, *e.at_most);
  if (e.at_least && !(value >= *e.at_least)) return fmt::format("{} {:.4g} < {:.4g}", e.name, value, *e.at_least);
  return "";
}

/// Violations of the motion check, which applies to every scene; a NaN statistic is a violation.
std::string fault_of_motion(const std::map<std::string, double>& summary) {
  std::string wrong;
  for (const motion_check::Statistic& s : motion_check::statistics()) {
    const auto at = summary.find(kMotionCheck + s.name);
    if (at == summary.end() || at->second <= 1) continue;
    wrong += (wrong.empty() ? "" : "; ") +
             fmt::format("{} ({}) {:.3g} times its tolerance", s.name, motion_check::name_of(s.check), at->second);
  }
  return wrong;
}

}  // namespace

std::size_t RunPlan::size() const {
  std::size_t n = 0;
  for (const auto& g : groups) n += g.size();
  return n;
}

const SolverEntry* RunPlan::add_not_built(const std::string& solver) {
  auto absent = std::make_shared<SolverEntry>();
  absent->info.name = solver;
  return not_built.emplace_back(std::move(absent)).get();
}

std::vector<std::string> solver_faults(const std::vector<RunRecord>& runs) {
  struct Ends {
    int finished = 0, failed = 0;
    std::string last;  ///< failure of the solver's last run that did not finish
  };
  std::map<std::string, Ends> by_solver;
  for (const RunRecord& r : runs) {
    const Outcome& o = r.outcome;
    if (o.status == "unsupported" || o.status == "over_budget" || o.status == "missing") continue;
    Ends& e = by_solver[r.header.solver];
    const bool good = o.status == "ok" || o.expect == "pass";
    ++(good ? e.finished : e.failed);
    if (!good) e.last = o.message.empty() ? o.status : o.status + ": " + o.message;
  }
  std::vector<std::string> out;
  for (const auto& [solver, e] : by_solver)
    if (e.finished == 0)
      out.push_back(fmt::format("{}: finished none of {} runs; the last: {}", solver, e.failed, e.last));
  return out;
}

RunResult execute_runs(const RunPlan& given, const RunOptions& options) {
  RunResult result;
  std::size_t done = 0;
  RunPlan plan = given;
  if (plan.references) {
    std::vector<const Scene*> scenes;
    for (const auto& group : plan.groups)
      for (const RunSpec& c : group) scenes.push_back(c.scene);
    const auto note = [&](const std::string& what) {
      if (options.progress) options.progress(what, 0, plan.size());
    };
    const auto found = references(scenes, options.reference_cache, note, {}, options.device);
    std::map<std::string, std::map<std::string, double>> dependence;
    for (auto& group : plan.groups)
      for (RunSpec& c : group) {
        const std::string& id = c.scene->sha256;
        auto r = found.find(id);
        // A duplicated layer, which only some solvers have, does not change the solution of the group's scene.
        if (c.scene->converged.substeps > 0)
          for (auto other = group.begin(); r == found.end() && other != group.end(); ++other)
            r = found.find(other->scene->sha256);
        if (r != found.end()) {
          c.scene_values = r->second.scalars();
          c.converged = r->second.mean;
        }
        if (!dependence.contains(id)) dependence[id] = truth_dependence(*c.scene);
        c.scene_values.insert(dependence[id].begin(), dependence[id].end());
      }
  }
  for (const auto& group : plan.groups) GroupRun(plan, options, result, done).run(group);
  if (options.progress) options.progress("", done, plan.size());
  return result;
}

Judgement judge(const Scene& scene, const Outcome& outcome, const AccuracyPass& pass,
                const std::map<std::string, double>& summary) {
  Judgement v;
  const std::string expected = expected_outcome(scene);
  const std::vector<Expectation> bounds = expectations(scene, summary);
  const bool checked = summary.contains(kMotionCheck + "finite");
  if (expected.empty() && bounds.empty() && !checked) return v;
  const bool known = measured(scene, outcome, pass);
  const auto note = [&](const std::string& name, const std::string& wrong) {
    v.scalars[kExpect + name] = !known ? kMissing : wrong.empty() ? 1 : 0;
    if (!wrong.empty() && known) v.text += (v.text.empty() ? "fail: " : "; ") + wrong;
  };
  if (!expected.empty())
    note("outcome", outcome.status == expected ? "" : "outcome " + outcome.status + ", expected " + expected);
  // The motion is checked as far as it goes; the scene's own bounds need a complete run.
  const std::string wrong_motion = fault_of_motion(summary);
  if (checked) v.scalars[kExpect + "motion"] = wrong_motion.empty() ? 1 : 0;
  if (!wrong_motion.empty()) v.text += (v.text.empty() ? "fail: " : "; ") + wrong_motion;
  for (const Expectation& e : bounds) note(e.name, fault(e, value_of(summary, e.name)));
  if (!known && wrong_motion.empty())
    v.text = "not measured";
  else if (v.text.empty())
    v.text = "pass";
  return v;
}

}  // namespace clothbench
