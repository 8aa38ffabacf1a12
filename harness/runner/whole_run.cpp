#include "runner/whole_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "results/replay.hpp"
#include "results/store.hpp"
#include "runner/expect.hpp"
#include "runner/frame_loop.hpp"

namespace clothbench {
namespace {

bool finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

double quantity_now(const truth::ReferenceCase& known, const Scene& scene, const ClothSolver& solver) {
  ClothState state;
  solver.read_state(state);
  return known.quantity(truth::column_means(scene.cloth, state.position));
}

}  // namespace

RunRecord whole_run(const RunSpec& spec, const DeviceOptions& device, const std::string& protocol,
                    const std::filesystem::path& out, double limit_s, const truth::ReferenceCase* by) {
  SolverRun run(spec, device, protocol);
  RunRecord record;
  record.header = run.header();
  std::unique_ptr<RunWriter> writer;
  if (!out.empty()) writer = std::make_unique<RunWriter>(out, run.header());
  TrialRules rules;
  rules.trials = 0;
  rules.accuracy_duration_s = spec.scene->time.duration_s;
  rules.run_limit_s = limit_s;
  if (run.alive()) record.accuracy = run.run_accuracy(rules);
  record.outcome = run.outcome();
  if (const int messages = run.validation_messages(); messages > 0)
    record.outcome = {"error", "ok", -1, fmt::format("{} validation messages", messages)};
  record.summary = summarise(run.spec(), run.plan(), record);
  if (by != nullptr && record.outcome.status == "ok")
    record.summary["truth_quantity"] = quantity_now(*by, *spec.scene, *run.solver());
  Verdict verdict = judge(*spec.scene, record.outcome, record.accuracy, record.summary);
  record.outcome.expect = std::move(verdict.text);
  record.summary.merge(verdict.scalars);
  if (!writer) return record;
  if (!record.accuracy.time_s.empty()) {
    writer->write_replay(replay_of(*spec.scene));
    writer->write_accuracy(record.accuracy);
  }
  writer->finish(record.outcome, record.summary);
  return record;
}

RunHeader bare_header(const RunSpec& spec, const std::string& protocol) {
  RunHeader h;
  h.scene = spec.scene->name;
  h.solver = spec.entry->info.name;
  h.setting = spec.setting;
  h.settings = spec.settings;
  h.scenario_json = spec.scene->json;
  h.scenario_sha256 = spec.scene->sha256;
  h.environment = {{"protocol", protocol}};
  return h;
}

RunRecord end_of_run(const RunSpec& spec, const DeviceOptions& device, const std::string& protocol,
                     const truth::ReferenceCase* by) {
  const Scene& scene = *spec.scene;
  RunRecord record;
  record.header = bare_header(spec, protocol);
  if (!unsupported(spec.entry->info, scene.needs).empty()) {
    record.outcome.status = "unsupported";
    return record;
  }
  const auto solver = load_solver(*spec.entry, spec.settings, device, scene);
  FrameLoop loop(*solver, scene, {.frames = scene.time.frames()});
  while (loop.next()) {
  }
  record.outcome = outcome_of(loop.status(), loop.index() + 1);
  if (loop.failed()) return record;
  ClothState state;
  solver->read_state(state);
  if (!finite(state.position) || !finite(state.velocity))
    record.outcome = outcome_of(StepStatus::NotFinite, scene.time.frames());
  else if (const auto own = by == nullptr ? truth::reference_case_of(scene) : std::nullopt; by != nullptr || own)
    record.summary["truth_quantity"] = quantity_now(by != nullptr ? *by : *own, scene, *solver);
  return record;
}

}  // namespace clothbench
