#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"
#include "report/grid.hpp"

namespace clothbench {

struct ReportOptions {
  std::filesystem::path out;
};

/// All runs of study folders, or result files, without trajectories. Planned runs without a file have the
/// status "missing". Throws Error naming the file that cannot be read.
std::vector<RunRecord> collect(const std::vector<std::filesystem::path>& results);

/// results/paper-table3.json, as it was at build time.
nlohmann::json published_table3();

/// Tables of one scene at its resolutions; pure functions of the runs. If the scene is that of the paper's Table 3,
/// the first table has the published rows.
std::vector<Table> fps_tables(const Family&, const nlohmann::json& published);

/// Runs that did not end well, by solver, status and message; only the header if there is none.
Table failed_table(const std::vector<RunRecord>& runs);

/// Runs that broke a bound of their scene's `expect`, by scene and solver; the note counts the others. Only the header
/// if there is none.
Table expect_table(const std::vector<RunRecord>& runs);

enum class Format { Markdown, Console };

/// Head of a report: whether the device is software; device, protocol and commit, one line for each combination among
/// the runs; the plugins; the overhead of the harness.
std::string headline(const std::vector<RunRecord>& runs, Format);

/// The GPU that a run ran on, and whether it is software; empty for a CPU.
std::string gpu_of(const RunRecord&);

/// The ballistic solver's slowest run as a share of a 72 Hz frame, against the 1 % allowed; empty without such runs.
std::string overhead_line(const std::vector<RunRecord>& runs);

/// Values of the device's own counters during the runs' trials, one row a run; only the header if no run has any.
Table sampled_table(const std::vector<RunRecord>& runs);

/// Names in `summary` of the values of the device's own counters.
const std::vector<std::string>& sampled_names();

/// "5 s windows, or the whole trial where it is shorter (here 0.3 s to 2 s)"; empty if no run has bytes.
std::string window_note(const std::vector<RunRecord>& runs);

/// One row a run with every summary value, as the shortest text that reads back exactly; missing = empty.
std::string runs_csv(const std::vector<RunRecord>& runs);

/// The same with only the summary values `names`.
std::string summary_csv(const std::vector<RunRecord>& runs, const std::vector<std::string>& names);

/// Published and measured values of Table 3, one row a run.
std::string table3_csv(const Family&, const nlohmann::json& published);
nlohmann::json table3_json(const Family&, const nlohmann::json& published);

/// Everything except frames: outcome, summary (missing = null), environment.
nlohmann::json runs_json(const std::vector<RunRecord>& runs);

/// Writes into `out`; throws Error if a file cannot be read or written:
///   - always: report.md, tables.tex, runs.csv, runs.json, bandwidth.csv, memory.csv, features.json;
///   - samples of the device's own counters: device-samples.csv; the paper's Table 3: table3.md, .csv, .json;
///   - scenes with contact: penetration.md, .csv, .json, penetration-series.csv;
///   - scenes with a truth: work-precision.md, .csv, .json, and one page, summary.md;
///   - effective moduli: material.md, .json; friction: friction.md, .json; features: feature-cost.md, .csv, .json;
///   - the page index.html, if this was built with Node, and its figures as pictures (draw_pictures), if Node is
///     installed; otherwise a line that says so.
void write_report(const std::vector<std::filesystem::path>& results, const ReportOptions&);

/// The same tables on the terminal.
void print_console_report(const std::vector<std::filesystem::path>& results);

}  // namespace clothbench
