#include "studies/execute.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/tint.hpp"
#include "base/words.hpp"
#include "report/report.hpp"
#include "report/verdict.hpp"
#include "results/result_folder.hpp"
#include "runner/environment.hpp"
#include "runner/run_choice.hpp"
#include "runner/supervise.hpp"

namespace clothbench {
namespace {

nlohmann::json seconds_json(const RunResult& r) {
  nlohmann::json j = nlohmann::json::object();
  for (const auto& [name, s] : r.seconds) j[name] = {{"runs", s}};
  for (const auto& [name, s] : r.moduli_seconds) j[name]["moduli"] = s;
  return j;
}

/// Of all runs of a command those of its plan, as they are stored.
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
          {"moduli", r.moduli},
          {"moduli_left_out", r.moduli_left_out},
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
    const auto moduli = r.moduli_seconds.find(name);
    text += fmt::format("{}{} {:.1f}", text.empty() ? "" : ", ", name, s);
    if (moduli != r.moduli_seconds.end()) text += fmt::format(" + {:.1f} on moduli", moduli->second);
    all += s + (moduli == r.moduli_seconds.end() ? 0 : moduli->second);
  }
  text = fmt::format("seconds: {}; together {:.0f}\n", text, all);
  if (r.runs_over_budget > 0)
    text += fmt::format(
        "not run: {} settings, because their solvers had used all of their time on the scene "
        "(over_budget)\n",
        r.runs_over_budget);
  if (r.moduli_left_out > 0)
    text += fmt::format(
        "not run: effective moduli of {} settings on fronts, which could change no verdict; a full "
        "study measures all\n",
        r.moduli_left_out);
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
  const std::optional<Supervised> parent = supervised();
  StudyEnd end;
  end.out = parent ? parent->out : call.out.empty() ? default_folder(manifest.study) : call.out;
  const bool resume = parent ? parent->resume : call.resume;
  std::optional<ResultFolder> held;
  if (!parent)
    held.emplace(end.out, call.part ? ResultFolder::Use::Shared : ResultFolder::Use::Alone, call.command_line);
  require_same_runs(end.out, plan, resume);
  if (needs_supervision(plan)) {
    end.exit_code = supervise(plan, end.out, call.resume, call.words);
    end.told = true;
    return end;
  }
  const std::vector<std::string> names = run_names(plan);
  manifest.created = utc_now();
  manifest.command_line = call.command_line;
  if (manifest.runs.empty()) manifest.runs = names;
  write_manifest(end.out, manifest);

  const RunningNote note(parent);
  const RunOptions options{end.out, resume, call.device.options,
                           [&](const std::string& what, std::size_t done, std::size_t total) {
                             call.progress(what, done, total);
                             note.write(what);
                           }};
  const RunResult result = execute_runs(plan, options);
  end.faults = result.faults;
  if (!end.faults.empty()) end.exit_code = ExitCode::CheckFailed;
  end.json = [=, out = end.out, part = call.part] {
    const std::vector<RunRecord> runs = stored_runs(names, out);
    return summary_of(result, runs, out, part ? nlohmann::json::array() : figures_of(runs));
  };
  end.text = [=, out = end.out] { return text_of(result, names, out); };
  return end;
}

}  // namespace clothbench
