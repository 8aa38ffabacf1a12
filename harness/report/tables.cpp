#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/bytes.hpp"
#include "report/report.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

/// Four digits at most; beyond that in thousands or millions.
std::string fps(double v) {
  if (!std::isfinite(v)) return "–";
  if (v >= 999500) return significant(1e-6 * v, 3) + "M";
  return v >= 9999.5 ? significant(1e-3 * v, 3) + "k" : fmt::format("{:.{}f}", v, v >= 1000 ? 0 : 1);
}

std::string with_spread(double v, double spread) {
  if (!std::isfinite(v)) return "–";
  return fps(v) + " ± " +
         (std::isfinite(spread) ? fmt::format("{:.{}f} %", 100 * spread, spread >= 0.0995 ? 0 : 1) : "–");
}

/// Published values as they are printed there: to the unit.
void add_published(Table& t, const std::vector<Resolution>& columns, const nlohmann::json& published) {
  const nlohmann::json& resolutions = published.at("resolution");
  std::size_t at = 1;
  for (const nlohmann::json& column : published.at("columns")) {
    std::vector<std::string> row = {"published: " + column.at("name").get<std::string>(), column.value("sides", "–")};
    for (const Resolution& r : columns) {
      std::string cell = "–";
      for (std::size_t k = 0; k < resolutions.size(); ++k)
        if (r.grid[0] == resolutions[k].get<int>() && r.grid[1] == r.grid[0])
          cell = fmt::format("{:g}", column.at("fps").at(k).get<double>());
      row.push_back(cell);
    }
    t.rows.insert(t.rows.begin() + static_cast<std::ptrdiff_t>(at++), std::move(row));
  }
}

std::string capped_note(const Family& f, bool paper) {
  std::string note = "Ours: mean over frames of min(72, 1/t), median of the trials, simulation alone.";
  if (paper)
    note =
        "Published: Quest 3, rendering included, values to the unit; 11 of the 15 read the display's 72, so this "
        "table cannot tell solvers apart: the next one can. " +
        note;
  if (std::any_of(f.cells.begin(), f.cells.end(), [](const PlacedCell& p) { return p.series.repeat > 1; }))
    note += " (2), (3): the same cell from another file.";
  return note;
}

/// Under tables of times and rates, why some are not printed; the others show what no clock tells.
void note_withheld(const Family& family, std::vector<Table>& tables) {
  std::vector<const CellRecord*> cells;
  for (const PlacedCell& p : family.cells) cells.push_back(p.cell);
  for (Table& t : tables)
    for (const char* timed : {"per second", "time a frame", "Frame time", "bandwidth"})
      if (t.title.find(timed) != std::string::npos) {
        t.note = with_withheld(t.note, cells, {"fps_median", "frame_wall_median_s"});
        break;
      }
}

/// A table is for families where a cell has such a value.
bool any_value(const Family& family, const char* name) {
  return std::any_of(family.cells.begin(), family.cells.end(),
                     [&](const PlacedCell& p) { return std::isfinite(summary_value(*p.cell, name)); });
}

}  // namespace

std::vector<Table> fps_tables(const Family& family, const nlohmann::json& published) {
  const bool paper = family.paper_table == 3;
  const std::string scene = paper ? "" : " (" + family.name + ")";
  std::vector<CellRecord> cells;  // summaries are enough for the notes
  for (const PlacedCell& p : family.cells) {
    cells.emplace_back();
    cells.back().summary = p.cell->summary;
  }
  const auto v = summary_value;
  std::vector<Table> t;
  t.push_back(family.table((paper ? "Table 3: frames" : "Frames") + std::string(" per second, capped at 72") + scene,
                           capped_note(family, paper), [&](const CellRecord& c) { return fps(v(c, "fps_at_72")); }));
  if (paper) add_published(t.back(), family.resolutions(), published);
  t.push_back(family.table("Frames per second, uncapped" + scene, "Median of the trials ± half their range.",
                           [&](const CellRecord& c) { return with_spread(v(c, "fps_median"), v(c, "fps_spread")); }));
  t.push_back(family.table("Wall time a frame [ms]" + scene, "Median over all timed frames.",
                           [&](const CellRecord& c) { return significant(1e3 * v(c, "frame_wall_median_s"), 3); }));
  if (any_value(family, "frame_rendered_median_s"))
    t.push_back(
        family.table("Frame time with rendering, stereo [ms]" + scene,
                     "Median wall time of a frame and its two pictures, nothing overlapping; the file says their size. "
                     "A GPU solver's buffer is drawn as it lies, a CPU solver's positions are uploaded. The paper's "
                     "FPS include rendering.",
                     [&](const CellRecord& c) { return significant(1e3 * v(c, "frame_rendered_median_s"), 3); }));
  if (any_value(family, "frame_pipelined_median_s"))
    t.push_back(family.table(
        "Wall time a frame, pipelined [ms]" + scene,
        "Frames not waited for, two in flight; median of the trials' means. – where a solver waits for each.",
        [&](const CellRecord& c) { return significant(1e3 * v(c, "frame_pipelined_median_s"), 3); }));
  t.push_back(family.table("GPU time a frame [ms]" + scene,
                           "Median; first to last timestamp of the frame's one submission. – on a CPU.",
                           [&](const CellRecord& c) { return significant(1e3 * v(c, "frame_device_median_s"), 3); }));
  if (any_value(family, "free_fall_error"))
    t.push_back(family.table("Free-fall error over gT²/2 at T = 0.5 s" + scene,
                             "Greatest distance of a vertex from the closed form of the solver's own integrator.",
                             [&](const CellRecord& c) {
                               const double e = v(c, "free_fall_error");
                               return std::isfinite(e) ? fmt::format("{:.1e}", e) : std::string("–");
                             }));
  if (any_value(family, "stretch_max_last_second"))
    t.push_back(family.table(
        "Stretch of structural edges in the last second, mean / greatest [%]" + scene,
        "Over edges and frames; edges shorter than at rest count as 0 in the mean.", [&](const CellRecord& c) {
          return paired(100 * v(c, "stretch_mean_last_second"), 100 * v(c, "stretch_max_last_second"), " / ", 2);
        }));
  t.push_back(
      family.table("kB a frame, read / written" + scene,
                   fmt::format("Bytes: {} – for CPU solvers, of which nothing is known.", kWhatBytesAre),
                   [](const CellRecord& c) { return bytes_pair(c, "read_B_per_frame", "write_B_per_frame", 1e-3); }));
  const std::string windows = window_note(cells);
  t.push_back(family.table("Peak bandwidth, read / written [GB/s]" + scene,
                           "The same bytes over wall time; " + (windows.empty() ? "no cell has any." : windows + "."),
                           [](const CellRecord& c) {
                             return bytes_pair(c, "bandwidth_read_peak_B_per_s", "bandwidth_write_peak_B_per_s", 1e-9);
                           }));
  t.push_back(family.table("Device memory [kB] · dispatches a frame" + scene,
                           "Buffers in device-local memory. – on a CPU.", [&](const CellRecord& c) {
                             const double m = v(c, "device_memory_B"), d = v(c, "dispatches");
                             return std::isfinite(m) || std::isfinite(d)
                                        ? significant(1e-3 * m, 4) + " · " + significant(d, 1)
                                        : std::string("–");
                           }));
  note_withheld(family, t);
  return t;
}

Table failed_table(const std::vector<CellRecord>& cells) {
  // One row for all cells with the same end: a feature a solver lacks is one line, not one a resolution.
  std::vector<std::vector<std::string>> rows;
  for (const CellRecord& c : cells) {
    if (c.outcome.status == "ok") continue;
    std::string status = c.outcome.status, scene = c.header.scene;
    if (c.outcome.klass != "ok" && !c.outcome.klass.empty()) status += " (" + c.outcome.klass + ")";
    if (c.outcome.failed_frame >= 0) scene += fmt::format(" (frame {})", c.outcome.failed_frame);
    std::vector<std::string> row = {Series{c.header.solver, c.header.setting, ""}.label(), status,
                                    c.outcome.message.empty() ? "–" : c.outcome.message, scene};
    const auto same = std::find_if(rows.begin(), rows.end(),
                                   [&](const auto& r) { return std::equal(r.begin(), r.begin() + 3, row.begin()); });
    if (same == rows.end())
      rows.push_back(std::move(row));
    else
      same->back() += ", " + scene;
  }
  Table t{"Cells without a result", "", {{"solver", "status", "message", "scenes"}}};
  t.rows.insert(t.rows.end(), rows.begin(), rows.end());
  return t;
}

Table expect_table(const std::vector<CellRecord>& cells) {
  Table t{"Expectations that were broken", "", {{"scene", "solver", "verdict"}}};
  std::size_t kept = 0, unknown = 0;
  for (const CellRecord& c : cells) {
    kept += c.outcome.expect == "kept";
    unknown += c.outcome.expect == "not measured";
    if (c.outcome.expect.starts_with("broken"))
      t.rows.push_back({c.header.scene, Series{c.header.solver, c.header.setting, ""}.label(), c.outcome.expect});
  }
  t.note = fmt::format("{} kept, {} not measured.", kept, unknown);
  return t;
}

}  // namespace clothbench
