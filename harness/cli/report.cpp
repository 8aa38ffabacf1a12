#include "report/report.hpp"

#include "cli/command.hpp"

namespace clothbench {

void add_report(CLI::App& app, Console& console) {
  auto& runs = console.arguments<std::vector<std::string>>();
  auto& out = console.arguments<std::string>();
  auto& history = console.arguments<std::string>();
  out = "report";
  CLI::App* cmd = app.add_subcommand(
      "report", "Write an interactive page, tables (Markdown, CSV, JSON) and figures (SVG, PDF) from result files");
  cmd->add_option("runs", runs, "Study folders or result files")->required();
  cmd->add_option("-o,--out", out, "Folder to write to")->capture_default_str();
  cmd->add_option("--history", history, "Also draw the changes from commit to commit in this log of `check --log`");
  cmd->footer("Example: clothbench report results/runs/table3-20260101T000000Z -o report");
  cmd->callback([&console, &runs, &out, &history] {
    std::vector<std::filesystem::path> paths(runs.begin(), runs.end());
    write_report(paths, out, history);
    if (console.json) return Console::print({{"out", out}});
    print_console_report(paths);
    const bool page = std::filesystem::exists(std::filesystem::path(out) / "index.html");
    fmt::print("\nreport: {}/{}\n", out, page ? "index.html (open it in a browser), report.md" : "report.md");
  });
}

}  // namespace clothbench
