#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/plugin_environment.hpp"
#include "base/tint.hpp"
#include "base/words.hpp"
#include "cli/command.hpp"
#include "report/report.hpp"
#include "report/verdict.hpp"
#include "results/result_folder.hpp"
#include "runner/environment.hpp"
#include "runner/study_plan.hpp"

namespace clothbench {
namespace {

/// Selects the stored runs that belong to the plan of a command.
std::vector<RunRecord> stored_runs(const std::vector<std::string>& names, const std::filesystem::path& out) {
  std::vector<RunRecord> runs = collect({out});
  std::erase_if(runs, [&](const RunRecord& c) { return !contains(names, run_name(c.header)); });
  withhold_times(runs);
  return runs;
}

/// Outcome and every figure of each run.
nlohmann::json figures_of(const std::vector<RunRecord>& runs) {
  nlohmann::json all = runs_json(runs);
  for (nlohmann::json& run : all) run.erase("environment");  // in the result files
  return all;
}

nlohmann::json summary_of(const RunResult& r, const std::vector<RunRecord>& runs, const std::filesystem::path& out,
                          nlohmann::json figures) {
  std::vector<std::string> failed;
  for (const RunRecord& c : runs)
    if (verdict(c) == "fail") failed.push_back(run_name(c.header) + ": " + c.outcome.expect);
  return {{"out", out.string()},
          {"ok", r.runs_ok},
          {"unsupported", r.runs_unsupported},
          {"over_budget", r.runs_over_budget},
          {"failed", r.runs_failed},
          {"grades", {{"stable", r.grades.stable}, {"degraded", r.grades.degraded}, {"failed", r.grades.failed}}},
          {"crashed", r.grades.crashed},
          {"seconds", r.seconds},
          {"faults", r.faults},
          {"with_bound", count_verdicts(runs).runs},
          {"expect_passed", count_verdicts(runs).passed},
          {"expect_failed", failed},
          {"runs", std::move(figures)}};
}

/// Where the time went, and what was not measured for its sake.
std::string spent(const RunResult& r) {
  if (r.seconds.empty()) return "";
  std::string text;
  double all = 0;
  for (const auto& [name, s] : r.seconds) {
    text += fmt::format("{}{} {:.1f}", text.empty() ? "" : ", ", name, s);
    all += s;
  }
  text = fmt::format("seconds: {}; together {:.0f}\n", text, all);
  if (r.runs_over_budget > 0)
    text += fmt::format("not run: {} settings, because settings of less work had timed out (over_budget)\n",
                        r.runs_over_budget);
  return text;
}

/// A few runs at a glance, under the tables; many are what the tables are for.
std::string text_of(const RunResult& r, const std::vector<std::string>& names, const std::filesystem::path& out) {
  constexpr std::size_t kFew = 24;
  const auto counted = [](int n, const char* what, Tone tone) {
    return tinted(n > 0 ? tone : Tone::Plain, fmt::format("{} {}", n, what));
  };
  const std::vector<RunRecord> runs = stored_runs(names, out);
  const VerdictCounts verdicts = count_verdicts(runs);
  std::string text = fmt::format("\n{}, {}, {}", counted(r.runs_ok, "runs ok", Tone::Good),
                                 counted(r.runs_unsupported, "unsupported", Tone::Doubtful),
                                 counted(r.runs_failed, "failed", Tone::Bad));
  if (r.grades.any())
    text += fmt::format("; {} stable, {} degraded, {} failed ({} of them crashed or hung)", r.grades.stable,
                        r.grades.degraded, r.grades.failed, r.grades.crashed);
  if (verdicts.runs > 0) text += "; with a bound: " + verdicts.text();
  return (names.empty() || names.size() > kFew ? "" : in_short_table(runs).console()) + text +
         fmt::format("; results in {}\n", out.string()) + spent(r);
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

void execute_study(RunPlan plan, StudyManifest manifest, const RunFlags& flags, Console& console,
                   const std::function<void()>& before_runs) {
  settle_device(plan, flags.device);
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
  if (!result.faults.empty()) console.exit_code = ExitCode::CheckFailed;
  for (const std::string& fault : result.faults) fmt::print(stderr, "FAULT {}\n", fault);
  if (!console.json && !flags.part) print_console_report({out});
  console.print(
      [&] {
        const std::vector<RunRecord> runs = stored_runs(names, out);
        return summary_of(result, runs, out, flags.part ? nlohmann::json::array() : figures_of(runs));
      },
      [&] { return text_of(result, names, out); });
}

}  // namespace clothbench
