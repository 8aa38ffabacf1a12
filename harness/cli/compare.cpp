#include "base/files.hpp"
#include "cli/command.hpp"
#include "report/compare_runs.hpp"
#include "report/report.hpp"
#include "report/withheld.hpp"

namespace clothbench {

void add_compare(CLI::App& app, Console& console) {
  auto &a = console.arguments<std::string>(), &b = console.arguments<std::string>(),
       &markdown = console.arguments<std::string>();
  CLI::App* cmd = app.add_subcommand(
      "compare",
      "Compare two results of the same study: which runs are faster or slower beyond noise, and which "
      "results differ");
  cmd->add_option("a", a, "Study folder or result file: before")->required();
  cmd->add_option("b", b, "Study folder or result file: after")->required();
  cmd->add_option("--markdown", markdown, "Also write the tables to this file, for a pull request");
  cmd->footer("Example: clothbench compare results/runs/before results/runs/after --markdown comparison.md");
  cmd->callback([&console, &a, &b, &markdown] {
    std::vector<RunRecord> before = collect({a}), after = collect({b});
    withhold_times(before);
    withhold_times(after);
    const std::vector<ComparedRun> runs = compare_runs(before, after);
    const std::vector<Table> tables = comparison_tables(runs);
    std::string text, page = fmt::format("A: `{}`, B: `{}`\n\n", a, b);
    for (const Table& t : tables) {
      const bool any = t.rows.size() > 1;
      text += any ? t.console() : fmt::format("\n{}: none\n  {}\n", t.title, t.note);
      page += any ? t.markdown() + "\n" : t.title + ": none. " + t.note + "\n\n";
    }
    if (!markdown.empty()) write_file_atomically(markdown, page);
    console.print([&] { return comparison_json(runs); }, [&] { return text; });
  });
}

void add_history(CLI::App& app, Console& console) {
  auto& folders = console.arguments<std::vector<std::string>>();
  CLI::App* cmd = app.add_subcommand("history",
                                     "Print times and errors as JSON for charts over commits (github-action-benchmark: "
                                     "customSmallerIsBetter)");
  cmd->add_option("runs", folders, "Study folders or result files")->required();
  cmd->footer("Example: clothbench history results/runs/mine > benchmark.json");
  cmd->callback([&folders] {
    std::vector<RunRecord> runs = collect({folders.begin(), folders.end()});
    withhold(runs);
    Console::print(history_json(runs));
  });
}

}  // namespace clothbench
