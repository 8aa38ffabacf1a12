#include "trial.hpp"

#include <stdexcept>

#include "metrics/registry.hpp"
#include "results/store.hpp"
#include "runner/study_runner.hpp"
#include "solvers.hpp"

namespace clothbench {
namespace {

/// A solver that gets a changed scene, or whose output is changed.
class Faulty final : public WrappedSolver {
 public:
  Faulty(std::unique_ptr<ClothSolver> inner, const Fault& fault) : WrappedSolver(std::move(inner)), fault_(fault) {}

  void load(const Scene& scene) override {
    given_ = scene;
    if (fault_.scene) fault_.scene(given_);
    inner_->load(given_);
  }
  void reset() override {
    frame_ = 0;
    inner_->reset();
  }
  StepStatus step(const FrameInput& given) override {
    FrameInput input = given;
    input.motion = given_.motion_after(given.index);
    if (fault_.input) fault_.input(given_, input);
    ++frame_;
    const StepStatus status = inner_->step(input);
    return fault_.status ? fault_.status(frame_) : status;
  }
  void read_state(ClothState& out) const override {
    inner_->read_state(out);
    if (fault_.state) fault_.state(frame_, out);
  }
  Plan plan() const override {
    Plan p = inner_->plan();
    if (fault_.plan) fault_.plan(p);
    return p;
  }

 private:
  const Fault& fault_;
  Scene given_;
  int frame_ = 0;
};

bool in_solver(const Fault& f) { return f.scene || f.input || f.state || f.status || f.plan; }

/// The pass's metrics, computed again with a different scene.
std::vector<MetricSeries> measured_in(const Scene& scene, const Stage& stage, const nlohmann::json& settings,
                                      const AccuracyPass& pass) {
  MetricPass again(MetricContext{scene, stage.entry, settings});
  const std::size_t numbers = 3 * scene.cloth.vertex_count();
  for (std::size_t f = 0; f < pass.time_s.size(); ++f) {
    const auto* x = pass.position.data() + f * numbers;
    again.add({std::vector<double>(x, x + numbers), std::vector<double>(numbers, 0)});
  }
  return again.take();
}

}  // namespace

RunRecord execute_run(const Stage& stage, const Fault* fault) {
  SolverEntry entry = stage.entry;
  if (fault != nullptr && in_solver(*fault))
    entry.make = [make = stage.entry.make, fault](const nlohmann::json& s, const DeviceOptions& d) {
      return std::make_unique<Faulty>(make(s, d), *fault);
    };
  std::optional<ShaderVariant> variant;
  if (fault != nullptr && fault->shader) variant.emplace(*fault->shader);
  RunSpec spec{&stage.scene, &entry, complete_settings(entry.info, stage.settings)};
  if (fault != nullptr && fault->settings) fault->settings(spec.settings);
  TrialRules rules;
  rules.frames = rules.min_frames = 12;
  rules.warmup_s = 0;
  rules.profiled_frames = 0;
  rules.accuracy_duration_s = stage.scene.time.duration_s;
  SolverRun run(spec, {}, "test");
  RunRecord record;
  record.header = run.header();
  if (run.alive()) record.accuracy = run.run_accuracy(rules);
  for (int k = 0; k < stage.trials && run.alive(); ++k) record.trials.push_back(run.run_trial(k, rules, 0));
  if (variant && ShaderVariant::exchanged() == 0)
    throw std::runtime_error(fault->name + ": no kernel of the run has the fault");
  if (fault != nullptr && fault->metric_scene) {
    Scene seen = stage.scene;
    fault->metric_scene(seen);
    record.accuracy.metrics = measured_in(seen, stage, spec.settings, record.accuracy);
  }
  if (fault != nullptr && fault->metrics) fault->metrics(record.accuracy);
  record.outcome = run.outcome();
  record.summary = summarise(spec, run.plan(), record);
  const Judgement verdict = judge(stage.scene, record.outcome, record.accuracy, record.summary);
  record.outcome.expect = verdict.text;
  for (const auto& [name, value] : verdict.scalars) record.summary[name] = value;
  if (fault != nullptr && fault->record) fault->record(record);
  return record;
}

}  // namespace clothbench
