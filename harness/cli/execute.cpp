#include <fmt/format.h>

#include <cmath>
#include <set>

#include "base/child_process.hpp"
#include "base/words.hpp"
#include "cli/command.hpp"
#include "report/report.hpp"
#include "results/store.hpp"
#include "runner/environment.hpp"
#include "runner/study_plan.hpp"

namespace clothbench {
namespace {

/// Reads the stored runs of a command's plan.
std::vector<RunRecord> stored_runs(const std::vector<std::string>& names, const std::filesystem::path& out) {
  std::vector<RunRecord> runs = collect({out});
  std::erase_if(runs, [&](const RunRecord& c) { return !contains(names, run_name(c.header)); });
  return withhold_times(std::move(runs));
}

/// Outcome and all scalars of each run.
nlohmann::json figures_of(const std::vector<RunRecord>& runs) {
  nlohmann::json all = runs_json(runs);
  for (nlohmann::json& run : all) run.erase("environment");  // it is in the result files
  return all;
}

/// Counts of outcomes, and of stability grades.
struct Ends {
  int ok = 0, unsupported = 0, over_budget = 0, failed = 0;
  int stable = 0, degraded = 0, unstable = 0, crashed = 0;  ///< crashed: unstable runs whose process crashed or hung

  explicit Ends(const std::vector<RunRecord>& runs) {
    for (const RunRecord& r : runs) {
      const std::string& status = r.outcome.status;
      ++(status == "ok" ? ok : status == "unsupported" ? unsupported : status == "over_budget" ? over_budget : failed);
      const auto at = r.summary.find("stability_grade");
      if (at == r.summary.end() || std::isnan(at->second) || status == "unsupported") continue;
      ++(at->second == 0 ? stable : at->second == 1 ? degraded : unstable);
      if (status == "crashed" || r.outcome.message.starts_with("its process")) ++crashed;
    }
  }
};

nlohmann::json summary_of(const std::vector<std::string>& faults, const std::vector<RunRecord>& runs,
                          const std::filesystem::path& out) {
  std::vector<std::string> failed;
  for (const RunRecord& c : runs)
    if (verdict(c) == "fail") failed.push_back(run_name(c.header) + ": " + c.outcome.expect);
  const Ends ends(runs);
  return {{"out", out.string()},
          {"ok", ends.ok},
          {"unsupported", ends.unsupported},
          {"over_budget", ends.over_budget},
          {"failed", ends.failed},
          {"grades", {{"stable", ends.stable}, {"degraded", ends.degraded}, {"failed", ends.unstable}}},
          {"crashed", ends.crashed},
          {"faults", faults},
          {"with_bound", count_verdicts(runs).runs},
          {"expect_passed", count_verdicts(runs).passed},
          {"expect_failed", failed},
          {"runs", figures_of(runs)}};
}

/// `part`: no report was printed, so the text starts with a short table of the runs.
std::string text_of(const std::vector<RunRecord>& runs, const std::filesystem::path& out, bool part) {
  const VerdictCounts verdicts = count_verdicts(runs);
  const Ends ends(runs);
  std::string text = fmt::format("\n{} runs ok, {} unsupported, {} failed", ends.ok, ends.unsupported, ends.failed);
  if (ends.stable + ends.degraded + ends.unstable > 0)
    text += fmt::format("; {} stable, {} degraded, {} failed ({} of them crashed or hung)", ends.stable, ends.degraded,
                        ends.unstable, ends.crashed);
  if (verdicts.runs > 0) text += "; criteria: " + verdicts.text();
  text += fmt::format("; results in {}\n", out.string());
  if (ends.over_budget > 0)
    text += fmt::format("not run: {} settings, because settings with less work had timed out (over_budget)\n",
                        ends.over_budget);
  return (part ? in_short_table(RunTable(runs)).console() : "") + text;
}

}  // namespace

std::filesystem::path default_folder(const std::string& study) {
  std::string stamp = utc_now();
  std::erase_if(stamp, [](char c) { return c == '-' || c == ':'; });
  const std::string first = (std::filesystem::path("results/runs") / (study + "-" + stamp)).string();
  std::filesystem::path folder = first;
  for (int n = 2; std::filesystem::exists(folder); ++n) folder = first + "-" + std::to_string(n);
  return folder;
}

void execute_study(const RunPlan& plan, StudyManifest manifest, const RunFlags& flags, Console& console,
                   const std::function<void()>& before_runs) {
  require_device(plan, flags.device.options);
  const std::filesystem::path out =
      flags.out.empty() ? default_folder(manifest.study) : std::filesystem::path(flags.out);
  const std::vector<std::string> names = run_names(plan);
  const std::set<std::string> mine(names.begin(), names.end());
  std::vector<std::size_t> numbers;
  for (std::size_t k = 0; flags.part && k < manifest.runs.size(); ++k)
    if (mine.contains(manifest.runs[k])) numbers.push_back(k);
  const ResultFolder held(out, numbers, console.command_line);
  require_same_runs(out, plan, flags.resume);
  manifest.created = utc_now();
  manifest.command_line = console.command_line;
  if (manifest.runs.empty()) manifest.runs = names;
  write_manifest(out, manifest);

  if (before_runs) before_runs();
  RunResult result;
  {
    StatusLine line(!console.json);
    RunOptions options;
    options.out = out;
    options.resume = flags.resume;
    options.jobs = flags.jobs;
    options.device = flags.device.options;
    options.progress = [&](const std::string& what, std::size_t done, std::size_t of) { line.show(what, done, of); };
    result = solvers_in_process() ? execute_runs(plan, options) : execute_in_worker(plan, options, flags.eye);
  }
  const std::vector<RunRecord> runs = stored_runs(names, out);
  for (std::string& fault : solver_faults(runs)) result.faults.push_back(std::move(fault));
  if (!result.faults.empty()) console.exit_code = ExitCode::CheckFailed;
  for (const std::string& fault : result.faults) fmt::print(stderr, "FAULT {}\n", fault);
  if (!console.json && !flags.part) print_console_report({out});
  console.print([&] { return summary_of(result.faults, runs, out); }, [&] { return text_of(runs, out, flags.part); });
}

}  // namespace clothbench
