#include "base/files.hpp"
#include "cli/command.hpp"
#include "report/compare_runs.hpp"
#include "report/report.hpp"
#include "report/withheld.hpp"

namespace clothbench {

namespace {

struct CompareArguments {
  std::string a, b, markdown;
  std::vector<std::string> allowed;
};

namespace fs = std::filesystem;

/// One folder of results, or the folders in a folder that has no results itself, by name.
std::vector<fs::path> folders_of(const fs::path& given) {
  std::vector<fs::path> inside;
  if (!fs::is_directory(given) || fs::exists(given / "study.json")) return {given};
  for (const auto& entry : fs::directory_iterator(given)) {
    if (!entry.is_directory()) return {given};
    inside.push_back(entry.path());
  }
  std::sort(inside.begin(), inside.end());
  return inside.empty() ? std::vector{given} : inside;
}

/// `given`: folders or files, separated by commas.
Processes read_processes(const std::string& given) {
  Processes out;
  for (const std::string& one : CLI::detail::split(given, ','))
    for (const fs::path& folder : folders_of(one)) withhold_times(out.emplace_back(collect({folder})));
  return out;
}

void compare(const CompareArguments& given, Console& console) {
  const Processes a = read_processes(given.a), b = read_processes(given.b);
  const Comparison comparison = compare_runs(a, b, given.allowed);
  const std::string marks = comparison.differing.marks();
  std::string text = marks, page;
  for (std::size_t at = 0, end; at < marks.size(); at = end + 1) {
    end = marks.find('\n', at);
    page += "**" + marks.substr(at, end - at) + "**\n\n";
  }
  page += fmt::format("A: `{}`, B: `{}`\n\n", given.a, given.b);
  for (const Table& t : comparison_tables(comparison)) {
    const bool any = t.rows.size() > 1;
    text += any ? t.console() : fmt::format("\n{}: none\n  {}\n", t.title, t.note);
    page += any ? t.markdown() + "\n" : t.title + ": none. " + t.note + "\n\n";
  }
  if (!given.markdown.empty()) write_file_atomically(given.markdown, page);
  console.print([&] { return comparison_json(comparison); }, [&] { return text; });
}

}  // namespace

void add_compare(CLI::App& app, Console& console) {
  auto& given = console.arguments<CompareArguments>();
  CLI::App* cmd = app.add_subcommand(
      "compare",
      "Compare two results of the same study: which runs are faster or slower beyond noise, and which "
      "results differ");
  const std::string several = fmt::format(
      "; for a statement about times {} or more of separate processes, run in turns: A,B,C,D,E or the folder that "
      "holds "
      "them",
      kMinProcesses);
  cmd->add_option("a", given.a, "Study folder or result file: before" + several)->required();
  cmd->add_option("b", given.b, "Study folder or result file: after; likewise")->required();
  cmd->add_option("--allow", given.allowed, "Compare although these differ, and mark the output")
      ->delimiter(',')
      ->check(CLI::IsMember(condition_kinds()));
  cmd->add_option("--markdown", given.markdown, "Also write the tables to this file, for a pull request");
  cmd->footer(
      "Exit codes: 0 compared, 2 bad input, or runs under different conditions.\n"
      "Example: clothbench compare results/runs/before results/runs/after --markdown comparison.md");
  cmd->callback([&console, &given] { compare(given, console); });
}

}  // namespace clothbench
