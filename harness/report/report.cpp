#include "report/report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "clothbench/error.hpp"
#include "report/paths.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

nlohmann::json published_table3() {
  const fs::path file = fs::path(kResultsRoot) / "paper-table3.json";
  std::ifstream in(file);
  if (!in) throw Error(file.string() + ": cannot be opened");
  return nlohmann::json::parse(in);
}

void collect_folder(const fs::path& dir, std::vector<CellRecord>& cells) {
  for (const std::string& name : read_manifest(dir).cells) {
    const fs::path file = dir / (name + ".h5"), part = dir / (name + ".part");
    if (fs::exists(file)) cells.push_back(read_cell_summary(file));
    else if (fs::exists(part / "outcome.raw")) cells.push_back(read_cell_summary(part));
    else {
      CellRecord missing;
      missing.header.scene = name;
      missing.outcome = {"missing", "ok", -1, "planned, not run"};
      cells.push_back(missing);
    }
  }
}

nlohmann::json cells_json(const std::vector<CellRecord>& cells) {
  nlohmann::json all = nlohmann::json::array();
  for (const CellRecord& c : cells)
    all.push_back({{"scene", c.header.scene}, {"solver", c.header.solver}, {"setting", c.header.setting}, {"settings", c.header.settings},
                   {"scenario_sha256", c.header.scenario_sha256},
                   {"outcome", {{"status", c.outcome.status}, {"class", c.outcome.klass}, {"failed_frame", c.outcome.failed_frame}, {"message", c.outcome.message}}},
                   {"summary", c.summary}, {"environment", c.header.environment}});
  return all;
}

bool quiet_success(const std::string& command) { return std::system((command + " >/dev/null 2>&1").c_str()) == 0; }

/// Figures from cells.csv. Returns a line for the report: what was drawn, or why not.
std::string draw_figures(const fs::path& out) {
  for (const char* python : {"/usr/bin/python3", "python3"}) {
    if (!quiet_success(std::string(python) + " -c 'import matplotlib'")) continue;
    const std::string command = fmt::format("{} '{}' '{}' '{}'", python, (fs::path(kScriptsRoot) / "plot_report.py").string(),
                                            (out / "cells.csv").string(), (fs::path(kResultsRoot) / "paper-table3.json").string());
    if (std::system(command.c_str()) != 0) throw Error("figures: the command failed: " + command, ExitCode::CheckFailed);
    return "";
  }
  return "Figures were left out: no Python with matplotlib (Debian: python3-matplotlib).";
}

}  // namespace

std::vector<CellRecord> collect(const std::vector<fs::path>& runs) {
  std::vector<CellRecord> cells;
  for (const fs::path& run : runs) {
    if (!fs::exists(run)) throw Error(run.string() + ": no such file or folder");
    if (fs::is_directory(run) && run.extension() != ".part") collect_folder(run, cells);
    else cells.push_back(read_cell_summary(run));
  }
  return cells;
}

void write_report(const std::vector<fs::path>& runs, const ReportOptions& options) {
  const std::vector<CellRecord> cells = collect(runs);
  fs::create_directories(options.out);
  write_file_atomically(options.out / "cells.csv", cells_csv(cells));
  write_file_atomically(options.out / "cells.json", cells_json(cells).dump(1) + "\n");
  const std::vector<Table> tables = fps_tables(cells, published_table3());
  std::string table3;
  for (const auto& row : tables.front().rows) table3 += csv_row(row);
  write_file_atomically(options.out / "table3.csv", table3);
  const std::string no_figures = draw_figures(options.out);

  std::string md = "# clothbench report\n\n" + headline(cells) + "\n";
  for (const Table& t : tables) md += t.markdown() + "\n";
  if (no_figures.empty())
    md += "### Figures\n\n![Frames per second by resolution](fig4.svg)\n\nFig. 4: frames per second by resolution, uncapped; grey: published.\n\n"
          "![Bandwidth by resolution](fig5.svg)\n\nFig. 5: counted bytes per second, peak over 5 s windows. CPU solvers have none.\n\n";
  else md += no_figures + "\n\n";
  md += "`cells.csv` and `cells.json` hold every value of every cell in full precision.\n";
  write_file_atomically(options.out / "report.md", md);
  if (!no_figures.empty()) fmt::print(stderr, "{}\n", no_figures);
}

void print_console_report(const std::vector<fs::path>& runs) {
  const std::vector<CellRecord> cells = collect(runs);
  fmt::print("{}", headline(cells));
  for (const Table& t : fps_tables(cells, published_table3())) fmt::print("{}", t.console());
}

}  // namespace clothbench
