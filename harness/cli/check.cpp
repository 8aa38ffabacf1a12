#include <fstream>

#include "base/files.hpp"
#include "check/compare.hpp"
#include "cli/command.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

struct CheckArguments {
  std::vector<std::string> runs, allowed;
  std::string baseline, junit, log;
  bool update = false, github = false;
};

void update(const CheckArguments& a, const std::vector<RunRecord>& runs, const Console& console) {
  const Baseline old = fs::exists(a.baseline) ? read_baseline(a.baseline) : Baseline{};
  const Updated updated = update_baseline(old, runs);
  write_file_atomically(a.baseline, baseline_text(updated.baseline));
  fmt::print(stderr, "{}", updated.differing.marks("The old and the new baseline differ"));
  console.print([&] { return update_json(updated, a.baseline); }, [&] { return update_text(updated, a.baseline); });
}

void check(const CheckArguments& a, const std::vector<RunRecord>& runs, Console& console) {
  const Checked checked = check_runs(read_baseline(a.baseline), runs, a.allowed);
  if (!a.junit.empty()) write_file_atomically(a.junit, junit_xml(checked));
  if (a.github) fmt::print(stderr, "{}", github_annotations(checked));
  console.print([&] { return check_json(checked, a.baseline); }, [&] { return check_text(checked, a.baseline); });
  if (!checked.passed()) console.exit_code = ExitCode::CheckFailed;
  if (a.log.empty()) return;
  const fs::path study = a.runs.front();
  const std::string command = fs::is_directory(study) ? read_manifest(study).command_line : "";
  if (!(std::ofstream(a.log, std::ios::app) << log_line(withhold_times(runs), command) << std::flush))
    throw Error(a.log + ": could not be written");
}

}  // namespace

void add_check(CLI::App& app, Console& console) {
  CheckArguments& a = console.arguments<CheckArguments>();
  CLI::App* cmd = app.add_subcommand(
      "check",
      "Compare results with a baseline: outcome, stages, dispatches, error, penetration; times are not "
      "compared");
  cmd->add_option("runs", a.runs, "Study folders or result files")->required();
  cmd->add_option("--baseline", a.baseline, "Baseline file, such as results/baselines/penetration.json")->required();
  CLI::Option* rewrite =
      cmd->add_flag("--update", a.update, "Rewrite the baseline from these results and print the changes");
  cmd->add_option(
         "--allow", a.allowed,
         "Check despite differences from the baseline in these conditions, separated by commas, and mark the output")
      ->delimiter(',')
      ->check(CLI::IsMember({"scene", "device", "precision", "length"}))
      ->excludes(rewrite);
  cmd->add_option("--junit", a.junit, "Also write JUnit XML with one test case per run")->excludes(rewrite);
  cmd->add_option("--log", a.log, "Append commit and values to this file, as one line for `report --history`")
      ->excludes(rewrite);
  cmd->add_flag("--github", a.github, "Also print failures as annotations of GitHub Actions, on stderr")
      ->excludes(rewrite);
  cmd->footer(
      "Exit codes: 0 every run is as in the baseline or better, 1 a finding fails (harness/check/README.md "
      "lists them), 2 bad input, or runs measured under conditions different from the baseline's.\nExample: "
      "clothbench check results/runs/mine --baseline results/baselines/penetration.json --junit check.xml");
  cmd->callback([&console, &a] {
    if (!a.junit.empty() && fs::is_regular_file(a.junit))
      fs::remove(a.junit);  // no old verdict may remain if the check fails
    if (!a.update && !fs::exists(a.baseline))
      throw Error(a.baseline + ": no such baseline; --update creates it from these results");
    const std::vector<RunRecord> runs = collect(std::vector<fs::path>(a.runs.begin(), a.runs.end()));
    if (a.update)
      update(a, runs, console);
    else
      check(a, runs, console);
  });
}

}  // namespace clothbench
