#pragma once
#include <filesystem>
#include <vector>

#include "clothbench/record.hpp"
#include "report/table.hpp"

namespace clothbench {

struct ReportOptions {
  std::filesystem::path out;
};

/// All cells of study folders, result files or part folders, without trajectories. Planned cells without a file are
/// rows with status "missing".
std::vector<CellRecord> collect(const std::vector<std::filesystem::path>& runs);

/// Tables of the frame-rate study; pure functions of the cells.
std::vector<Table> fps_tables(const std::vector<CellRecord>& cells, const nlohmann::json& published);

/// What a reader must know first: device, protocol, commit, and whether the device is software.
std::string headline(const std::vector<CellRecord>& cells);

/// One row a cell, every summary value in full precision.
std::string cells_csv(const std::vector<CellRecord>& cells);

/// Writes report.md, cells.csv, table3.csv, table3.json and the figures fig4 and fig5 (SVG, PNG; left out, with a line
/// saying so, where there is no Python with matplotlib).
void write_report(const std::vector<std::filesystem::path>& runs, const ReportOptions&);

/// The same tables on the terminal.
void print_console_report(const std::vector<std::filesystem::path>& runs);

}  // namespace clothbench
