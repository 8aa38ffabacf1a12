#include "runner/solver_run.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "metrics/registry.hpp"
#include "metrics/stability/judge.hpp"
#include "results/store.hpp"
#include "runner/environment.hpp"
#include "runner/frame_loop.hpp"
#include "runner/interrupt.hpp"
#include "runner/reference.hpp"

namespace clothbench {
namespace {

using Clock = std::chrono::steady_clock;

double unix_now() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Rules for the frames of a trial, which restarts the scene with every drop.
FrameRules frame_rules(const TrialRules& rules, int frames, double max_wall_s = 0) {
  return {0, frames, rules.drop_frames, max_wall_s, rules.min_frames, kTrialsKept};
}

nlohmann::json plan_json(const Plan& plan, const Scene& scene) {
  nlohmann::json j;
  for (const BufferPlan& b : plan.buffers)
    j["buffers"].push_back({{"name", b.name}, {"bytes", b.bytes}, {"device_local", b.device_local}});
  for (const LeftOut& l : plan.left_out) {
    j["left_out"].push_back({{"what", l.what}, {"why", l.why}});
    if (!l.no_parameter.empty()) j["left_out"].back()["no_parameter"] = l.no_parameter;
  }
  if (plan.substeps > 0) j["substeps"] = plan.substeps;
  // One entry per collider, in the scene's order, because names may repeat.
  for (std::size_t k = 0; k < std::min(plan.contact_margins_m.size(), scene.colliders.size()); ++k) {
    const Collider& c = scene.colliders[k];
    const double stated = plan.contact_margins_m[k];
    j["contact_margins"].push_back({{"collider", c.name}, {"margin_m", std::isfinite(stated) ? stated : c.margin_m}});
  }
  return j;
}

/// Appends the solver's counts after a frame, one series per count. Returns the reason if a count is an error.
std::string add_counts(const ClothSolver& solver, std::size_t frames, std::vector<MetricSeries>& series) {
  std::string fault;
  std::vector<SolverCount> counts;
  try {
    counts = solver.counts();
  } catch (const SolverError& e) {
    for (MetricSeries& s : series) s.values.push_back(kMissing);
    return e.what();
  }
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const SolverCount& c = counts[k];
    if (series.size() <= k) series.push_back({c.name, "1", c.long_name, std::vector<double>(frames - 1, kMissing)});
    series[k].values.push_back(c.count);
    if (!(c.count <= 0) && !c.fault.empty() && fault.empty()) fault = fmt::format("{} ({:g})", c.fault, c.count);
  }
  return fault;
}

/// A twin of the solver, loaded with a setting that slows it; null if it lacks that setting or is not on a GPU.
std::unique_ptr<ClothSolver> twin_with(const char* setting, const RunSpec& spec, const DeviceOptions& device) {
  nlohmann::json settings = spec.settings;
  if (!settings.contains(setting) || !spec.entry->info.on_gpu) return nullptr;
  settings[setting] = settings[setting].is_boolean() ? nlohmann::json(true) : nlohmann::json(1);
  std::unique_ptr<ClothSolver> twin = spec.entry->make(settings, device);
  twin->load(*spec.scene);
  return twin;
}

}  // namespace

std::string run_name(const RunSpec& c) { return run_name(c.scene->name, c.entry->info.name, c.setting); }

RunHeader header_of(const Scene& scene, const std::string& solver, const std::string& setting,
                    const nlohmann::json& settings, const std::string& protocol) {
  RunHeader h;
  h.scene = scene.name;
  h.solver = solver;
  h.setting = setting;
  h.settings = settings;
  h.scenario_json = scene.json;
  h.scenario_sha256 = scene.sha256;
  h.environment = describe_environment({}, protocol);
  h.vertices = static_cast<std::uint32_t>(scene.cloth.vertex_count());
  for (const auto& t : triangles(scene.cloth)) h.triangles.insert(h.triangles.end(), t.begin(), t.end());
  return h;
}

SolverRun::SolverRun(RunSpec spec, const DeviceOptions& device, const std::string& protocol)
    : spec_(std::move(spec)), device_(device) {
  const Scene& scene = *spec_.scene;
  const SolverInfo& info = spec_.entry->info;
  header_ = header_of(scene, info.name, spec_.setting, spec_.settings, protocol);
  const auto describe_run = [&] {
    if (!scene.assets.empty()) header_.environment["assets"] = scene.assets;
    if (spec_.entry->make) describe_solver(info, header_.environment);
  };
  describe_run();
  const std::string missing = missing_features(info, scene.needs);
  if (!spec_.entry->make || !missing.empty()) {
    outcome_ = {"unsupported", "ok", -1, spec_.entry->make ? missing : "not in this build"};
    return;
  }
  if (!spec_.over_budget.empty()) {
    outcome_ = {"over_budget", "ok", -1, spec_.over_budget};
    return;
  }
  try {
    solver_ = spec_.entry->make(spec_.settings, device_);
    const auto start = Clock::now();
    solver_->load(scene);
    header_.load_s = seconds_since(start);
  } catch (const UnsupportedScene& e) {
    solver_.reset();
    outcome_ = {"unsupported", "ok", -1, info.name + ": " + e.what()};
    return;
  } catch (const SolverError& e) {
    solver_.reset();
    outcome_ = {"error", "F3", -1, e.what()};
    return;
  }
  header_.environment = describe_environment(solver_->device(), protocol);
  describe_run();
  plan_ = solver_->plan();
  header_.plan = plan_json(plan_, scene);
  for (const StagePlan& s : plan_.stages) {
    StageRecord record{s.name, {}, s.dispatches};
    s.serves.for_each([&](Feature f) { record.serves.emplace_back(name_of(f)); });
    header_.stages.push_back(std::move(record));
  }
  if (const std::string fault = check_stages(scene, info, plan_); !fault.empty())
    outcome_ = {"error", "ok", -1, "stages: " + fault};
}

Outcome outcome_of(StepStatus status, int frame) {
  switch (status) {
    case StepStatus::Ok:
      break;
    case StepStatus::NotFinite:
      return {"not_finite", "F0", frame, "a position or velocity is not finite"};
    case StepStatus::Diverged:
      return {"diverged", "F0", frame, "the solver stopped without a solution"};
    case StepStatus::DeviceLost:
      return {"device_lost", "F3", frame, "the device was lost"};
    case StepStatus::TimedOut:
      return {"timed_out", "F3", frame, "the device did not finish in time"};
  }
  return {};
}

void SolverRun::fail(StepStatus status, int frame) {
  if (status != StepStatus::Ok) outcome_ = outcome_of(status, frame);
}

int SolverRun::accuracy_frames(double duration_s) const {
  const TimeSpan& time = spec_.scene->time;
  return static_cast<int>(std::lround(std::min(duration_s, time.duration_s) * time.frame_rate_hz));
}

bool SolverRun::take_over(const RunRecord& before, double duration_s) {
  if (!before.summary.contains(kUntimed)) return false;
  const bool whole = before.accuracy.time_s.size() == static_cast<std::size_t>(accuracy_frames(duration_s)) + 1;
  if (before.outcome.status == "ok" && !whole) return false;
  // Concurrent passes share the GPU (but no CPU core), so a pass on a GPU may have timed out because of the others.
  if (before.outcome.status == "timed_out" && spec_.entry->info.on_gpu) return false;
  outcome_ = before.outcome;
  return true;
}

AccuracyPass SolverRun::run_accuracy(const TrialRules& rules,
                                     const std::function<void(const AccuracyPass&)>& after_frame) {
  const Scene& scene = *spec_.scene;
  const int frames = accuracy_frames(rules.accuracy_duration_s);
  const auto start = Clock::now();
  const int held_before = times_held();
  const MetricContext context{scene, *spec_.entry, spec_.settings, plan_.contact_margins_m};
  AccuracyPass pass;
  MetricPass metrics(context);
  std::vector<MetricSeries> counts;
  solver_->reset();
  ClothState state;
  pass.position.reserve(static_cast<std::size_t>(frames + 1) * scene.cloth.vertex_count() * 3);
  const auto observe = [&](int frame, StepStatus status) {
    fail(status, frame);
    try {
      solver_->read_state(state);
    } catch (const Error& e) {  // a lost device returns no state
      if (outcome_.status == "ok") outcome_ = {"device_lost", "F3", frame, e.what()};
      return;
    }
    if (outcome_.status == "ok" && !(finite(state.position) && finite(state.velocity)))
      fail(StepStatus::NotFinite, frame);
    pass.time_s.push_back(scene.time.at(frame));
    for (double x : state.position) pass.position.push_back(static_cast<float>(x));
    if (after_frame) after_frame(pass);
    metrics.add(state);
    const std::string fault = add_counts(*solver_, pass.time_s.size(), counts);
    if (outcome_.status == "ok" && !fault.empty()) outcome_ = {"error", "ok", frame, fault};
    if (outcome_.status == "ok" && metrics.lost())
      outcome_ = {"diverged", "F0", frame, "speed or energy exceeds every bound"};
    // The time limit does not apply to a pass that was paused.
    if (outcome_.status == "ok" && rules.run_limit_s > 0 && times_held() == held_before &&
        seconds_since(start) > rules.run_limit_s && frame < frames)
      outcome_ = {"timed_out", "F3", frame,
                  fmt::format("the accuracy pass did not finish within {:g} s", rules.run_limit_s)};
  };
  stop_if_interrupted(kTrialsKept);
  observe(0, StepStatus::Ok);
  FrameLoop loop(*solver_, scene, {.frames = frames, .interrupted = kTrialsKept});
  while (outcome_.status == "ok" && (loop.next() || loop.failed())) observe(loop.index() + 1, loop.status());
  pass.metrics = metrics.take();
  pass.metrics.insert(pass.metrics.end(), counts.begin(), counts.end());
  const StabilityVerdict verdict = stability_verdict(pass);
  if (verdict.klass != "ok" && outcome_.klass != "F3") {
    outcome_.klass = verdict.klass;
    outcome_.failed_frame = verdict.frame;
    if (outcome_.message.empty() || outcome_.status == "diverged") outcome_.message = verdict.text();
  }
  return pass;
}

void SolverRun::warm_up(const TrialRules& rules) {
  constexpr int kLeastFrames = 3;
  solver_->reset();
  const auto start = Clock::now();
  FrameLoop loop(*solver_, *spec_.scene, frame_rules(rules, kAsManyAsItTakes));
  while (loop.next()) {
    const double since_s = seconds_since(start);
    if (loop.index() + 1 >= kLeastFrames && since_s >= rules.warmup_s) return;
    // One frame that lasts as long as a whole trial is enough warm-up.
    if (rules.max_wall_s > 0 && since_s >= std::max(rules.max_wall_s, rules.warmup_s)) return;
  }
}

TimedTrial SolverRun::run_trial(int index, const TrialRules& rules, int frames) {
  TimedTrial trial;
  trial.index = index;
  try {
    measure(trial, rules, frames);
  } catch (const SolverError& e) {  // its costs are inconsistent, or its twin could not be loaded
    outcome_ = {"error", "F3", -1, e.what()};
  }
  return trial;
}

void SolverRun::measure(TimedTrial& trial, const TrialRules& rules, int frames) {
  const int jobs_before = jobs_now();
  const TimeSpan& time = spec_.scene->time;
  const bool in_windows = rules.window_s > 0;
  if (!in_windows || !std::exchange(warm_, true)) warm_up(rules);
  const int asked = rules.frames > 0 ? rules.frames : time.frames();
  trial.start_unix_s = trial.end_unix_s = unix_now();
  solver_->reset();
  FrameRules timed = frames > 0 ? frame_rules(rules, frames) : frame_rules(rules, asked, rules.max_wall_s);
  if (in_windows) {
    timed = frame_rules(rules, static_cast<int>(std::lround(rules.window_s * time.frame_rate_hz)));
    timed.period_s = time.dt();
    timed.drop_frames = time.frames();
    timed.end_after_s = rules.window_s;  // late frames: fewer of them
  }
  timed.cpu_clock = !spec_.entry->info.on_gpu;
  FrameLoop loop(*solver_, *spec_.scene, timed);
  while (loop.next()) {
    add_frame(trial, solver_->last_cost(), loop.wall_s(), plan_.stages.size());
    if (timed.cpu_clock) trial.frame_cpu_s.push_back(loop.cpu_s());
  }
  fail(loop.status(), loop.index());
  trial.end_unix_s = unix_now();
  trial.jobs = std::max(jobs_before, jobs_now());
  if (outcome_.status == "ok" && rules.pipelined && solver_->frames_in_flight() > 1) run_pipelined(trial, rules);
  if (outcome_.status == "ok" && rules.rendering.make) run_rendered(trial, rules);
  if (outcome_.status == "ok" && rules.profiled_frames > 0) {
    profile_stages(trial, rules.profiled_frames);
    count_bytes(trial, rules);
  }
}

/// Runs the trial's frames again, pipelined within each drop; the clock includes filling and draining the pipeline at
/// the start and end of a drop.
void SolverRun::run_pipelined(TimedTrial& trial, const TrialRules& rules) {
  solver_->reset();
  FrameLoop loop(*solver_, *spec_.scene, frame_rules(rules, trial.frames()));
  while (loop.next_drop()) {
  }
  fail(loop.status(), loop.index());
  if (!loop.failed()) trial.pipelined_wall_s = loop.elapsed_s() / trial.frames();
}

void SolverRun::describe(const TrialRules& rules) {
  const auto& text = rules.rendering.describe;
  if (text && solver_) header_.environment["rendering"] = text(spec_.entry->info);
  if (rules.window_s > 0) header_.environment["window_s"] = rules.window_s;
}

/// Runs the trial's frames again and draws each before the next begins; fewer frames if drawing exceeds the trial's
/// time limit. Each trial makes its own drawer: the images of all runs of a group would exhaust device memory.
void SolverRun::run_rendered(TimedTrial& trial, const TrialRules& rules) {
  solver_->reset();
  const std::unique_ptr<FrameDrawer> drawer = rules.rendering.make(*spec_.scene, *solver_, device_);
  drawer->draw(0);  // a driver's first image takes longer
  solver_->reset();
  FrameLoop loop(*solver_, *spec_.scene, frame_rules(rules, trial.frames(), rules.max_wall_s));
  const auto step_and_draw = [&](const FrameInput& input) {
    const StepStatus status = solver_->step(input);
    if (status == StepStatus::Ok) drawer->draw(input.index + 1);
    return status;
  };
  while (loop.next(step_and_draw)) trial.frame_rendered_s.push_back(loop.wall_s());
  fail(loop.status(), loop.index());
}

/// Per-stage device times come from a twin with timestamps around every stage, which runs right after the timed frames,
/// because timestamps would slow the timed frames. Frames that the twin does not run stay NaN.
void SolverRun::profile_stages(TimedTrial& trial, int frames) {
  if (!profiled_) profiled_ = twin_with("stage_times", spec_, device_);
  if (!profiled_) return;
  profiled_->reset();
  const std::size_t stages = plan_.stages.size();
  FrameLoop loop(*profiled_, *spec_.scene, {.frames = std::min(frames, trial.frames()), .interrupted = kTrialsKept});
  while (loop.next()) {
    const FrameCost cost = profiled_->last_cost();
    for (std::size_t k = 0; k < std::min(stages, cost.stage_device_s.size()); ++k)
      trial.stage_device_s[static_cast<std::size_t>(loop.index()) * stages + k] = cost.stage_device_s[k];
  }
}

/// Bytes come from a twin whose kernels count them on the frames of the first trial; they are the same in all trials.
void SolverRun::count_bytes(TimedTrial& trial, const TrialRules& rules) {
  if (counted_.frames() != trial.frames()) {
    const std::unique_ptr<ClothSolver> twin = twin_with("count_bytes", spec_, device_);
    if (!twin) return;
    twin->reset();
    counted_ = {};
    FrameLoop loop(*twin, *spec_.scene, frame_rules(rules, trial.frames()));
    while (loop.next()) {
      add_frame(counted_, twin->last_cost(), loop.wall_s(), 0);
    }
    fail(loop.status(), loop.index());
    counted_messages_ += twin->validation_messages();
    if (loop.failed()) return;
  }
  trial.stage_read_B = counted_.stage_read_B;
  trial.stage_write_B = counted_.stage_write_B;
}

void add_frame(TimedTrial& trial, const FrameCost& cost, double wall_s, std::size_t stages) {
  trial.frame_wall_s.push_back(wall_s);
  trial.frame_device_s.push_back(cost.device_s);
  trial.stage_device_s.insert(trial.stage_device_s.end(), stages, kMissing);
  trial.stage_read_B.insert(trial.stage_read_B.end(), cost.stage_read_B.begin(), cost.stage_read_B.end());
  trial.stage_write_B.insert(trial.stage_write_B.end(), cost.stage_write_B.begin(), cost.stage_write_B.end());
}

std::map<std::string, double> summarise(const RunSpec& spec, const Plan& plan, const RunRecord& record) {
  const RunView run(*spec.scene, record, plan, spec.entry->info.on_gpu);
  std::map<std::string, double> s = scalars_of(run);
  for (const auto& [name, value] : spec.scene_values) s[name] = value;
  if (spec.converged) s["truth_error"] = converged_error(*spec.scene, record.accuracy, *spec.converged);
  return s;
}

constexpr FeatureSet kData = features_of(FeatureOf::Data);

std::string check_stages(const Scene& scene, const SolverInfo& info, const Plan& plan) {
  std::string fault;
  const FeatureSet implied = scene.needs - info.ignores - kData;
  FeatureSet served;
  for (const StagePlan& stage : plan.stages) {
    served |= stage.serves;
    (stage.serves - kData - implied).for_each([&](Feature f) {
      fault += "stage " + stage.name + " serves " + std::string(name_of(f)) + ", which the scene does not need; ";
    });
  }
  (implied - served).for_each([&](Feature f) { fault += "no stage serves " + std::string(name_of(f)) + "; "; });
  if (!plan.contact_margins_m.empty() && plan.contact_margins_m.size() != scene.colliders.size())
    fault += fmt::format("{} contact margins of {} colliders; ", plan.contact_margins_m.size(), scene.colliders.size());
  for (const double m : plan.contact_margins_m)
    if (!(m >= 0 || std::isnan(m)) || std::isinf(m)) fault += fmt::format("a contact margin of {} m; ", m);
  if (plan.stages.empty()) fault += "no stage at all; ";
  return fault.empty() ? fault : fault.substr(0, fault.size() - 2);
}

}  // namespace clothbench
