#include "check/compare.hpp"

#include "cli/command.hpp"

namespace clothbench {

namespace {

struct CompareArguments {
  std::string a, b;
  std::vector<std::string> allowed;
};

namespace fs = std::filesystem;

/// The folders in `given`, by name, if it contains only folders and no study.json; otherwise `given` itself.
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
    for (const fs::path& folder : folders_of(one)) out.push_back(withhold_times(collect({folder})));
  return out;
}

void compare(const CompareArguments& given, Console& console) {
  const Checked compared = compare_processes(read_processes(given.a), read_processes(given.b), given.allowed);
  console.print([&] { return comparison_json(compared); }, [&] { return comparison_text(compared); });
}

}  // namespace

void add_compare(CLI::App& app, Console& console) {
  auto& given = console.arguments<CompareArguments>();
  CLI::App* cmd = app.add_subcommand(
      "compare",
      "Compare two builds on the same runs: which runs are faster or slower beyond noise, and which results differ");
  const std::string several = fmt::format(
      "Results of one build: a study folder or result file. To compare times, give {} or more, separated by commas, or "
      "a folder that contains them; each from its own process, run in random order",
      kMinProcesses);
  cmd->add_option("a", given.a, several)->required();
  cmd->add_option("b", given.b, "Results of the other build, likewise")->required();
  cmd->add_option("--allow", given.allowed, "Compare despite these differences (comma-separated), and mark the output")
      ->delimiter(',')
      ->check(CLI::IsMember(condition_kinds()));
  cmd->footer(
      "Exit codes: 0 compared, 2 bad input, or runs under different conditions.\n"
      "Example: clothbench compare results/runs/before results/runs/after");
  cmd->callback([&console, &given] { compare(given, console); });
}

}  // namespace clothbench
