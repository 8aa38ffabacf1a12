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

/// All cells of study folders, result files or part folders, without trajectories. Planned cells without a file are
/// rows with status "missing". Throws Error naming the file that cannot be read.
std::vector<CellRecord> collect(const std::vector<std::filesystem::path>& runs);

/// results/paper-table3.json, as it was when this was built.
nlohmann::json published_table3();

/// Tables of one scene at its resolutions; pure functions of the cells. Where the scene is the paper's Table 3 the
/// first table has the published rows.
std::vector<Table> fps_tables(const Family&, const nlohmann::json& published);

/// Cells that did not end well, by solver, status and message; no rows but the header if there is none.
Table failed_table(const std::vector<CellRecord>& cells);

/// Cells that broke what their scene expects, by scene and solver; the note counts the others. No rows but the header
/// if there is none.
Table expect_table(const std::vector<CellRecord>& cells);

enum class Format { Markdown, Console };

/// What a reader must know first: whether the device is software; device, protocol and commit, one line for each
/// combination among the cells; what the harness itself costs.
std::string headline(const std::vector<CellRecord>& cells, Format);

/// The GPU that a cell ran on, and whether it is software; empty for a CPU.
std::string gpu_of(const CellRecord&);

/// The ballistic solver's slowest cell as a share of a 72 Hz frame, against the 1 % allowed; empty without such cells.
std::string overhead_line(const std::vector<CellRecord>& cells);

/// What the device's own counters told during the cells' trials, one row a cell; no rows but the header if no cell has
/// any.
Table sampled_table(const std::vector<CellRecord>& cells);

/// Names in `summary` of what the device's own counters told.
const std::vector<std::string>& sampled_names();

/// "5 s windows, or the whole trial where it is shorter (here 0.3 s to 2 s)"; empty if no cell has bytes.
std::string window_note(const std::vector<CellRecord>& cells);

/// One row a cell, every summary value, shortest text that reads back exactly; missing = empty.
std::string cells_csv(const std::vector<CellRecord>& cells);

/// The same with only some of the summary values.
std::string summary_csv(const std::vector<CellRecord>& cells, const std::vector<std::string>& names);

/// Published and measured values of Table 3, one row a cell.
std::string table3_csv(const Family&, const nlohmann::json& published);
nlohmann::json table3_json(const Family&, const nlohmann::json& published);

/// Everything but frames: outcome, summary (missing = null), environment.
nlohmann::json cells_json(const std::vector<CellRecord>& cells);

/// Writes report.md, cells.csv, cells.json, bandwidth.csv, memory.csv, features.json; for cells with samples of the
/// device's own counters device-samples.csv; for the paper's Table 3 also table3.md, .csv and .json; for scenes with
/// contact penetration.md, .csv and .json and penetration-series.csv; and for scenes with a truth work-precision.md,
/// .csv, .json and a page of summary.md; for material cards material.md and .json; for runs of friction friction.md and
/// .json; for costs of features feature-cost.md, .csv and .json; the page index.html (left out, with a line saying so,
/// where this was built without Node); its figures as pictures (draw_pictures; left out, with a line saying so, where
/// there is no Node). Throws Error if a file cannot be read or written.
void write_report(const std::vector<std::filesystem::path>& runs, const ReportOptions&);

/// The same tables on the terminal.
void print_console_report(const std::vector<std::filesystem::path>& runs);

}  // namespace clothbench
