#include "report/report.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>

#include "clothbench/error.hpp"
#include "report/paths.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kBandwidthNames = {"read_B_per_frame",
                                                  "write_B_per_frame",
                                                  "bandwidth_read_peak_B_per_s",
                                                  "bandwidth_read_mean_B_per_s",
                                                  "bandwidth_write_peak_B_per_s",
                                                  "bandwidth_write_mean_B_per_s",
                                                  "bandwidth_window_s"};
const std::vector<std::string> kMemoryNames = {"device_memory_B", "dispatches", "load_s"};
constexpr const char* kFigures[] = {"fig4.svg", "fig4.png", "fig5.svg", "fig5.png"};

/// A word that the shell takes as it stands.
std::string quoted(const fs::path& path) {
  std::string out = "'";
  for (const char c : path.string()) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// Figures from cells.csv. Returns what went wrong, or nothing; a missing matplotlib is told apart by `has_python`.
std::string draw_figures(const fs::path& out, bool& has_python) {
  for (const char* file : kFigures) fs::remove(out / file);  // an older run's figures are not this report's
  const fs::path script = fs::path(kScriptsRoot) / "plot_report.py";
  for (const char* python : {"/usr/bin/python3", "python3"}) {
    if (std::system((std::string(python) + " -c 'import matplotlib' >/dev/null 2>&1").c_str()) != 0) continue;
    has_python = true;
    const std::string command = fmt::format("{} {} {} {}", python, quoted(script), quoted(out / "cells.csv"),
                                            quoted(fs::path(kResultsRoot) / "paper-table3.json"));
    return std::system(command.c_str()) == 0 ? "" : "Figures were left out: this command failed: " + command;
  }
  has_python = false;
  return "Figures were left out: no Python with matplotlib (Debian: python3-matplotlib).";
}

std::string figures_markdown(const std::vector<CellRecord>& cells) {
  const std::string windows = window_note(cells);
  return fmt::format(R"(### Figures

![Frames per second by resolution](fig4.svg)

Fig. 4: frames per second by resolution, uncapped; bars: half the range of the trials; a cross on the lower edge: a cell
that failed; grey: published (Quest 3, capped at 72 Hz, rendering included). Ballistic, the harness without a cloth
model, lies above the axis.

![Bandwidth by resolution](fig5.svg)

Fig. 5: counted bytes per second of wall time, peak{}. CPU solvers are absent: their bytes are not counted, and never
modelled. The paper's values are published as a graph alone.

)",
                     windows.empty() ? "" : " over " + windows);
}

}  // namespace

nlohmann::json published_table3() {
  const fs::path file = fs::path(kResultsRoot) / "paper-table3.json";
  std::ifstream in(file);
  if (!in) throw Error(file.string() + ": cannot be opened");
  return nlohmann::json::parse(in);
}

void write_report(const std::vector<fs::path>& runs, const ReportOptions& options) {
  const std::vector<CellRecord> cells = collect(runs);
  const nlohmann::json published = published_table3();
  const auto write = [&](const char* name, const std::string& text) {
    write_file_atomically(options.out / name, text);
  };
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) throw Error(options.out.string() + ": cannot be made a folder: " + error.message());
  write("cells.csv", cells_csv(cells));
  write("cells.json", cells_json(cells).dump(1) + "\n");
  write("bandwidth.csv", summary_csv(cells, kBandwidthNames));
  write("memory.csv", summary_csv(cells, kMemoryNames));

  const std::string head = headline(cells, Format::Markdown);
  std::string tables;
  bool wrote_table3 = false;
  for (const Family& family : families(cells)) {
    std::string text;
    for (const Table& t : fps_tables(family, published)) text += t.markdown() + "\n";
    tables += text;
    if (family.paper_table != 3 || wrote_table3) continue;
    write("table3.md", "# Table 3\n\n" + head + "\n" + text);
    write("table3.csv", table3_csv(family, published));
    write("table3.json", table3_json(family, published).dump(1) + "\n");
    wrote_table3 = true;
  }
  if (const Table failed = failed_table(cells); failed.rows.size() > 1) tables += failed.markdown() + "\n";

  if (const Table broken = expect_table(cells); broken.rows.size() > 1) tables += broken.markdown() + "\n";

  bool has_python = false;
  const std::string no_figures = draw_figures(options.out, has_python);
  write("report.md", "# clothbench report\n\n" + head + "\n" + tables +
                         (no_figures.empty() ? figures_markdown(cells) : no_figures + "\n\n") +
                         "`cells.csv` and `cells.json` hold every summary value of every cell in full precision.\n");
  if (no_figures.empty()) return;
  if (has_python) throw Error(no_figures, ExitCode::CheckFailed);
  fmt::print(stderr, "{}\n", no_figures);
}

void print_console_report(const std::vector<fs::path>& runs) {
  const std::vector<CellRecord> cells = collect(runs);
  const nlohmann::json published = published_table3();
  fmt::print("{}", headline(cells, Format::Console));
  for (const Family& family : families(cells))
    for (const Table& t : fps_tables(family, published)) fmt::print("{}", t.console());
  const Table failed = failed_table(cells);
  if (failed.rows.size() > 1) fmt::print("\n{}\n", failed.title);
  for (std::size_t r = 1; r < failed.rows.size(); ++r) {
    const auto& row = failed.rows[r];  // messages are sentences: lines, not columns
    fmt::print("{}", wrapped(row[0] + ": " + row[1] + ": " + row[2] + ": " + row[3], 2, kConsoleColumns));
  }
  const Table broken = expect_table(cells);
  if (broken.rows.size() > 1) fmt::print("\n{} ({})\n", broken.title, broken.note.substr(0, broken.note.size() - 1));
  for (std::size_t r = 1; r < broken.rows.size(); ++r)
    fmt::print("{}", wrapped(broken.rows[r][0] + ": " + broken.rows[r][1] + ": " + broken.rows[r][2], 2, kConsoleColumns));
}

}  // namespace clothbench
