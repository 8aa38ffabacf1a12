#include <fmt/format.h>

#include <algorithm>
#include <set>

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

nlohmann::json seconds_json(const RunResult& r) {
  nlohmann::json j = nlohmann::json::object();
  for (const auto& [name, s] : r.seconds) j[name] = {{"runs", s}};
  return j;
}

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
          {"seconds", seconds_json(r)},
          {"faults", r.faults},
          {"with_bound", count_verdicts(runs).runs},
          {"expect_passed", count_verdicts(runs).passed},
          {"expect_failed", failed},
          {"runs", std::move(figures)}};
}

/// Where the time went, and what was not measured for its sake.
std::string spent(const RunResult& r) {
  std::string text;
  double all = 0;
  for (const auto& [name, s] : r.seconds) {
    text += fmt::format("{}{} {:.1f}", text.empty() ? "" : ", ", name, s);
    all += s;
  }
  text = fmt::format("seconds: {}; together {:.0f}\n", text, all);
  if (r.runs_over_budget > 0)
    text += fmt::format(
        "not run: {} settings, because their solvers had used all of their time on the scene "
        "(over_budget)\n",
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
  return (names.empty() || names.size() > kFew ? "" : in_short_table(runs).console()) +
         fmt::format("\n{}, {}, {}{}; results in {}\n", counted(r.runs_ok, "runs ok", Tone::Good),
                     counted(r.runs_unsupported, "unsupported", Tone::Doubtful),
                     counted(r.runs_failed, "failed", Tone::Bad),
                     verdicts.runs > 0 ? "; with a bound: " + verdicts.text() : "", out.string()) +
         spent(r);
}

VerdictCounts verdicts_in(const std::filesystem::path& out) {
  std::vector<RunRecord> runs = collect({out});
  withhold_times(runs);
  return count_verdicts(runs);
}

/// Summaries of a study whose runs are apart: verdicts, and stability grades unless its scenes are drawn.
void summarise_apart(const RunResult& r, bool drawn, StudyEnd& end) {
  const Grades n = r.grades;
  const std::filesystem::path out = end.out;
  end.json = [=] {
    const VerdictCounts counts = verdicts_in(out);
    nlohmann::json j = {{"out", out.string()}, {"passed", counts.passed}, {"runs", counts.runs}};
    if (!drawn)
      j.update({{"stable", n.stable},
                {"degraded", n.degraded},
                {"failed", n.failed},
                {"unsupported", n.unsupported},
                {"crashed", n.crashed}});
    return j;
  };
  end.text = [=] {
    const std::string grades =
        drawn ? ""
              : fmt::format("{} runs stable, {} degraded, {} failed ({} of them crashed or hung), {} unsupported; ",
                            n.stable, n.degraded, n.failed, n.crashed, n.unsupported);
    return fmt::format("\n{}{}; results in {}\n", grades, verdicts_in(out).text(), out.string());
  };
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

StudyEnd execute_study(RunPlan plan, StudyManifest manifest, const StudyCall& call) {
  settle_device(plan, call.device);
  StudyEnd end;
  end.out = call.out.empty() ? default_folder(manifest.study) : call.out;
  const std::vector<std::string> names = run_names(plan);
  const std::set<std::string> mine(names.begin(), names.end());
  std::vector<std::size_t> numbers;
  for (std::size_t k = 0; call.part && k < manifest.runs.size(); ++k)
    if (mine.contains(manifest.runs[k])) numbers.push_back(k);
  const ResultFolder held(end.out, numbers, call.command_line);
  require_same_runs(end.out, plan, call.resume);
  manifest.created = utc_now();
  manifest.command_line = call.command_line;
  if (manifest.runs.empty()) manifest.runs = names;
  write_manifest(end.out, manifest);

  if (call.before_runs) call.before_runs();
  RunOptions options;
  options.out = end.out;
  options.resume = call.resume;
  options.jobs = call.jobs;
  options.device = call.device.options;
  options.progress = call.progress;
  const RunResult result =
      runs_in_worker(plan) ? execute_in_worker(plan, options, call.eye) : execute_runs(plan, options);
  end.faults = result.faults;
  if (!end.faults.empty()) end.exit_code = ExitCode::CheckFailed;
  if (plan.apart) {
    summarise_apart(result, call.drawn, end);
    return end;
  }
  end.json = [=, out = end.out, part = call.part] {
    const std::vector<RunRecord> runs = stored_runs(names, out);
    return summary_of(result, runs, out, part ? nlohmann::json::array() : figures_of(runs));
  };
  end.text = [=, out = end.out] { return text_of(result, names, out); };
  return end;
}

}  // namespace clothbench
