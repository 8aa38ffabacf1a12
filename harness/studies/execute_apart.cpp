#include <fmt/format.h>

#include <set>

#include "report/report.hpp"
#include "report/verdict.hpp"
#include "results/result_folder.hpp"
#include "runner/child.hpp"
#include "runner/environment.hpp"
#include "runner/stability_map.hpp"
#include "studies/execute.hpp"

namespace clothbench {
namespace {

/// Where and how its processes run; the manifest is completed.
StabilityOptions options_apart(Study& study, StudyManifest& manifest, const StudyCall& call,
                               std::vector<std::string> only, int jobs) {
  StabilityOptions options;
  options.environment = settle_device(study, call.device, only);
  options.out = call.out.empty() ? default_folder(manifest.study) : call.out;
  options.program = own_program();
  options.device = call.device.options;
  options.resume = call.resume;
  options.jobs = jobs;
  options.solvers = std::move(only);
  options.progress = call.progress;
  manifest.created = utc_now();
  manifest.command_line = call.command_line;
  for (const Study::Item& item : study.scenes)
    for (const std::size_t k : item.solvers)
      manifest.runs.push_back(run_name(item.scene.name, study.solvers[k].solver, study.solvers[k].label));
  return options;
}

/// What the seeds drew, a line a scene; many scenes are what the result files are for.
void tell_drawn(const Study& study, const StudyCall& call) {
  constexpr std::size_t kFew = 24;
  std::set<std::string> names;
  for (const Study::Item& item : study.scenes) names.insert(item.scene.name);
  if (names.size() > kFew) return;
  for (const Study::Item& item : study.scenes) {
    if (names.erase(item.scene.name) == 0) continue;
    const nlohmann::json drawn = nlohmann::json::parse(item.scene.json)["drawn"];
    std::string text = fmt::format("{}: speed {:.3g} m/s;", item.scene.name, drawn["speed_m_per_s"].get<double>());
    for (const auto& [name, value] : drawn["values"].items())
      text += fmt::format(" {}={}", name, value.is_string() ? value.get<std::string>() : value.dump());
    call.tell(text);
  }
}

ExitCode exit_code_of(const SolverEnds& ends) { return ends.faults().empty() ? ExitCode::Ok : ExitCode::CheckFailed; }

StudyEnd execute_drawn(const Study& study, const StudyManifest& manifest, const StabilityOptions& options,
                       const StudyCall& call) {
  require_same_runs(study, options);
  write_manifest(options.out, manifest);
  tell_drawn(study, call);
  SolverEnds ends;
  execute_runs_apart(study, options, [&](const StudySolver& s, const RunRecord& a) { ends.add(s.solver, a.outcome); });
  const std::string out = options.out.string();
  std::vector<RunRecord> runs = collect({options.out});
  withhold_times(runs);
  const VerdictCounts counts = count_verdicts(runs);
  return {.out = options.out,
          .exit_code = exit_code_of(ends),
          .faults = ends.faults(),
          .json =
              [=] {
                return nlohmann::json{{"out", out}, {"passed", counts.passed}, {"runs", counts.runs}};
              },
          .text = [=] { return fmt::format("\n{}; results in {}\n", counts.text(), out); }};
}

StudyEnd execute_stability(const Study& study, const StudyManifest& manifest, const StabilityOptions& options) {
  require_same_study(study, options);
  write_manifest(options.out, manifest);
  StabilityCounts n = execute_stability_runs(study, options);
  n.add(run_stability_maps(study, options));
  const std::string out = options.out.string();
  return {.out = options.out,
          .exit_code = exit_code_of(n.ends),
          .faults = n.ends.faults(),
          .json =
              [=] {
                return nlohmann::json{{"out", out},         {"stable", n.stable},           {"degraded", n.degraded},
                                      {"failed", n.failed}, {"unsupported", n.unsupported}, {"crashed", n.crashed}};
              },
          .text =
              [=] {
                return fmt::format(
                    "\n{} runs stable, {} degraded, {} failed ({} of them crashed or hung), {} unsupported; results in "
                    "{}\n",
                    n.stable, n.degraded, n.failed, n.crashed, n.unsupported, out);
              }};
}

}  // namespace

StudyEnd execute_apart(Study study, StudyManifest manifest, const StudyCall& call, std::vector<std::string> only,
                       int jobs) {
  const StabilityOptions options = options_apart(study, manifest, call, std::move(only), jobs);
  const ResultFolder held(options.out, ResultFolder::Use::Alone, call.command_line);
  return is_drawn(study) ? execute_drawn(study, manifest, options, call) : execute_stability(study, manifest, options);
}

}  // namespace clothbench
