#include "runner/whole_run.hpp"

#include <fmt/format.h>

#include "results/replay.hpp"
#include "results/store.hpp"
#include "runner/expect.hpp"

namespace clothbench {
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

}  // namespace clothbench
