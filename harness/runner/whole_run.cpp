#include "runner/whole_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clothbench/unsupported_scene.hpp"
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

RunRecord whole_run(const RunSpec& spec, const RunRules& rules) {
  SolverRun run(spec, rules.device, rules.protocol);
  RunRecord record;
  record.header = run.header();
  std::unique_ptr<RunWriter> writer;
  if (!rules.out.empty()) writer = std::make_unique<RunWriter>(rules.out, run.header());
  TrialRules pass;
  pass.trials = 0;
  pass.accuracy_duration_s = spec.scene->time.duration_s;
  pass.run_limit_s = rules.limit_s;
  if (run.alive()) record.accuracy = run.run_accuracy(pass);
  record.outcome = run.outcome();
  if (const int messages = run.validation_messages(); messages > 0)
    record.outcome = {"error", "ok", -1, fmt::format("{} validation messages", messages)};
  record.summary = summarise(run.spec(), run.plan(), record);
  if (rules.by != nullptr && record.outcome.status == "ok")
    record.summary["truth_quantity"] = quantity_now(*rules.by, *spec.scene, *run.solver());
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

RunRecord end_of_run(const RunSpec& spec, const RunRules& rules) {
  const Scene& scene = *spec.scene;
  RunRecord record;
  record.header = bare_header(spec, rules.protocol);
  if (!unsupported(spec.entry->info, scene.needs).empty()) {
    record.outcome.status = "unsupported";
    return record;
  }
  std::unique_ptr<ClothSolver> solver;
  try {
    solver = load_solver(*spec.entry, spec.settings, rules.device, scene);
  } catch (const UnsupportedScene& e) {
    record.outcome = {"unsupported", "ok", -1, spec.entry->info.name + ": " + e.what()};
    return record;
  }
  FrameLoop loop(*solver, scene, {.frames = scene.time.frames()});
  while (loop.next()) {
  }
  record.outcome = outcome_of(loop.status(), loop.index() + 1);
  if (loop.failed()) return record;
  ClothState state;
  solver->read_state(state);
  if (!finite(state.position) || !finite(state.velocity))
    record.outcome = outcome_of(StepStatus::NotFinite, scene.time.frames());
  else if (const auto own = rules.by == nullptr ? truth::reference_case_of(scene) : std::nullopt; rules.by || own)
    record.summary["truth_quantity"] = quantity_now(rules.by ? *rules.by : *own, scene, *solver);
  return record;
}

}  // namespace clothbench
