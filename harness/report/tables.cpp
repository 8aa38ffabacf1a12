#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "report/bytes.hpp"
#include "report/plugin_marks.hpp"
#include "report/report.hpp"
#include "report/verdict.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

/// At most four digits; greater values in thousands or millions.
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

/// A row of the paper's table: a published solver, or a series of ours.
struct PaperRow {
  const nlohmann::json* published = nullptr;
  Series series = {};
};

/// Published rows, each with the rows below it of plugins that wrap its engine; then ours. `note` says what those are.
std::vector<PaperRow> paper_rows(const Family& family, const nlohmann::json& published, std::string& note) {
  std::vector<PaperRow> out;
  std::vector<Series> ours = family.series();
  const auto engine = [&](const Series& s) {
    return engine_of(
        *std::find_if(family.runs.begin(), family.runs.end(), [&](auto& p) { return p.series == s; })->run);
  };
  for (const nlohmann::json& column : published.at("columns")) {
    out.push_back({&column});
    const std::string wrapped = column.value("engine", "");
    const auto wraps = [&](const Series& s) { return !wrapped.empty() && engine(s) == wrapped; };
    for (const Series& s : ours)
      if (wraps(s)) out.push_back({nullptr, s});
    if (out.back().published == nullptr)
      note += fmt::format(" {}: {}", out.back().series.solver, column.value("peer", ""));
    std::erase_if(ours, wraps);
  }
  for (const Series& s : ours) out.push_back({nullptr, s});
  return out;
}

/// The family's table with the published values, as integers as in the paper.
Table paper_table(const Family& family, const nlohmann::json& published, const std::string& title, std::string note,
                  const std::function<std::string(const RunRecord&)>& text) {
  const std::vector<PaperRow> rows = paper_rows(family, published, note);
  const nlohmann::json& widths = published.at("resolution");
  static const auto name = [](const PaperRow& r) {
    return r.published == nullptr ? r.series.label() : "published: " + r.published->at("name").get<std::string>();
  };
  static const auto sides = [](const PaperRow& r) {
    return r.published == nullptr ? or_dash(r.series.sides) : r.published->value("sides", "–");
  };
  return Columns<PaperRow>{{"", "solver", name}, {"", "sides", sides}}
      .across(family.resolutions(), &Resolution::label,
              [&](const PaperRow& r, const Resolution& at) -> std::string {
                if (r.published == nullptr) return family.cell(r.series, at, text);
                for (std::size_t k = 0; k < widths.size(); ++k)
                  if (at.grid[0] == widths[k].get<int>() && at.grid[1] == at.grid[0])
                    return fmt::format("{:g}", r.published->at("fps").at(k).get<double>());
                return "";
              })
      .table({title, std::move(note), {}}, rows);
}

std::string capped_note(const Family& f, bool paper) {
  std::string note = "Ours: mean over frames of min(72, 1/t), median of the trials, without rendering.";
  if (paper)
    note =
        "Published: Quest 3, with rendering, rounded to whole frames. 11 of the 15 published values are the "
        "display's 72, so this table does not distinguish solvers; the next one does. " +
        note;
  if (std::any_of(f.runs.begin(), f.runs.end(), [](const PlacedRun& p) { return p.series.repeat > 1; }))
    note += " (2), (3): the same run from further files.";
  return note;
}

/// Adds to tables of times and rates why some values are withheld. Other tables do not depend on times.
void note_withheld(const Family& family, std::vector<Table>& tables) {
  std::vector<const RunRecord*> runs;
  for (const PlacedRun& p : family.runs) runs.push_back(p.run);
  for (Table& t : tables)
    for (const char* timed : {"per second", "time a frame", "Frame time", "bandwidth"})
      if (t.title.find(timed) != std::string::npos) {
        t.note = with_withheld(t.note, runs, {"fps_median", "frame_wall_median_s"});
        break;
      }
}

/// One table of a family: one value of each run, as text.
struct ValueTable {
  std::string title, note;
  std::function<std::string(const RunRecord&)> text;
  const char* only_with = nullptr;  ///< a summary value; no table if no run has it
  bool timed = false;               ///< shows where a run timed fewer frames than others of its scene
  bool of_gpus = false;             ///< no table where no run is of a GPU
};

ValueTable milliseconds(const char* title, const char* note, const char* name, const char* only_with = nullptr,
                        bool of_gpus = false) {
  return {title,     note, [name](const RunRecord& c) { return significant(1e3 * summary_value(c, name), 3); },
          only_with, true, of_gpus};
}

std::vector<ValueTable> time_tables() {
  return {
      {"Frames per second, uncapped", "Median of the trials ± half their range.",
       [](const RunRecord& c) { return with_spread(summary_value(c, "fps_median"), summary_value(c, "fps_spread")); },
       nullptr, true},
      milliseconds("Wall time a frame [ms]", "Median over all timed frames.", "frame_wall_median_s"),
      milliseconds("CPU time a frame [ms]",
                   "Median over the same frames; the sum over a solver's threads. –: a GPU solver.",
                   "frame_cpu_median_s", "frame_cpu_median_s"),
      milliseconds(
          "Frame time with rendering, stereo [ms]",
          "Median wall time of a frame and its two pictures, one after the other; the result file has the size "
          "of the pictures. A GPU solver's buffer is drawn in place; a CPU solver's positions are uploaded. "
          "The paper's FPS include rendering.",
          "frame_rendered_median_s", "frame_rendered_median_s"),
      milliseconds("Wall time a frame, pipelined [ms]",
                   "Two frames in flight; median of the trials' means. –: the solver waits for each frame.",
                   "frame_pipelined_median_s", "frame_pipelined_median_s"),
      milliseconds("GPU time a frame [ms]",
                   "Median; first to last timestamp of the frame's one submission. –: a CPU solver.",
                   "frame_device_median_s", nullptr, true),
  };
}

std::vector<ValueTable> error_tables() {
  return {
      {"Free-fall error over gT²/2 at T = 0.5 s",
       "Greatest distance of a vertex from the closed form of the solver's own integrator.",
       [](const RunRecord& c) {
         const double e = summary_value(c, "free_fall_error");
         return std::isfinite(e) ? fmt::format("{:.1e}", e) : std::string("–");
       },
       "free_fall_error"},
      {"Stretch of structural edges in the last second, mean / greatest [%]",
       "Mean and greatest over edges and frames. Edges shorter than at rest count as 0 in the mean.",
       [](const RunRecord& c) {
         return paired(100 * summary_value(c, "stretch_mean_last_second"),
                       100 * summary_value(c, "stretch_max_last_second"), " / ", 2);
       },
       "stretch_max_last_second"},
  };
}

std::vector<ValueTable> device_tables(const std::string& windows) {
  std::vector<ValueTable> out = {
      {"kB a frame, read / written",
       fmt::format("Bytes: {} –: a CPU solver, whose bytes are not known.", kWhatBytesAre),
       [](const RunRecord& c) { return bytes_pair(c, "read_B_per_frame", "write_B_per_frame", 1e-3); }},
      {"Peak bandwidth, read / written [GB/s]",
       "The same bytes divided by wall time; " + (windows.empty() ? "no run has byte counts." : windows + "."),
       [](const RunRecord& c) {
         return bytes_pair(c, "bandwidth_read_peak_B_per_s", "bandwidth_write_peak_B_per_s", 1e-9);
       }},
      {"Device memory [kB] · dispatches a frame", "Buffers in device-local memory. –: a CPU solver.",
       [](const RunRecord& c) {
         const double m = summary_value(c, "device_memory_B"), d = summary_value(c, "dispatches");
         return std::isfinite(m) || std::isfinite(d) ? significant(1e-3 * m, 4) + " · " + significant(d, 1)
                                                     : std::string("–");
       }},
  };
  for (ValueTable& t : out) t.of_gpus = true;
  return out;
}

/// Input of notes, which need only the summaries.
std::vector<RunRecord> summaries_of(const Family& family) {
  std::vector<RunRecord> runs;
  for (const PlacedRun& p : family.runs) runs.emplace_back().summary = p.run->summary;
  return runs;
}

bool any_value(const Family& family, const char* name) {
  return std::any_of(family.runs.begin(), family.runs.end(),
                     [&](const PlacedRun& p) { return std::isfinite(summary_value(*p.run, name)); });
}

/// Adds the table of a value, unless no run has one: of a GPU where there are only CPU solvers.
void add_values(const Family& family, const ValueTable& t, const std::string& scene, std::vector<Table>& tables) {
  std::vector<const RunRecord*> all;
  for (const PlacedRun& p : family.runs) all.push_back(p.run);
  // Values that are withheld leave a table with the reason.
  bool any = std::any_of(all.begin(), all.end(), [](const RunRecord* c) { return !c->withheld.empty(); });
  Table table = family.table(t.title + scene, t.note, [&](const RunRecord& c) {
    const std::string value = t.text(c);
    any = any || (value != "–" && !value.starts_with("– /"));
    return t.timed && value != "–" ? value + frames_mark(c, all) : value;
  });
  if (any) tables.push_back(std::move(table));
}

}  // namespace

std::vector<Table> fps_tables(const Family& family, const nlohmann::json& published) {
  const bool paper = family.paper_table == 3;
  const std::string scene = paper ? "" : " (" + family.name + ")";
  const std::string title = (paper ? "Table 3: frames" : "Frames") + std::string(" per second, capped at 72") + scene;
  const auto capped = [](const RunRecord& c) { return fps(summary_value(c, "fps_at_72")); };
  std::vector<Table> tables = {paper ? paper_table(family, published, title, capped_note(family, paper), capped)
                                     : family.table(title, capped_note(family, paper), capped)};
  const bool on_gpu =
      std::any_of(family.runs.begin(), family.runs.end(), [](const PlacedRun& p) { return !gpu_of(*p.run).empty(); });
  for (const auto& group : {time_tables(), error_tables(), device_tables(window_note(summaries_of(family)))})
    for (const ValueTable& t : group)
      if ((t.only_with == nullptr || any_value(family, t.only_with)) && (!t.of_gpus || on_gpu))
        add_values(family, t, scene, tables);
  note_withheld(family, tables);
  return tables;
}

Table failed_table(const std::vector<RunRecord>& runs) {
  // One row for all runs with the same ending: a missing feature is one line, not one per resolution.
  struct Ending {
    std::string solver, status, message, scenes = {};
    bool operator==(const Ending& o) const {
      return std::tie(solver, status, message) == std::tie(o.solver, o.status, o.message);
    }
  };
  std::vector<Ending> all;
  for (const RunRecord& c : runs) {
    if (c.outcome.status == "ok") continue;
    std::string scene = c.header.scene;
    if (c.outcome.failed_frame >= 0) scene += fmt::format(" (frame {})", c.outcome.failed_frame);
    const Ending same{label_of(c), status_with_class(c.outcome), c.outcome.message};
    std::string& scenes = find_or_add(
                              all, [&](const Ending& e) { return e == same; }, same)
                              .scenes;
    scenes += (scenes.empty() ? "" : ", ") + scene;
  }
  return Columns<Ending>{{"", "solver", &Ending::solver},
                         {"", "status", &Ending::status},
                         {"", "message", [](auto& e) { return or_dash(e.message); }},
                         {"", "scenes", &Ending::scenes}}
      .table({"Runs without a result", "", {}}, all);
}

Table expect_table(const std::vector<RunRecord>& runs) {
  std::vector<RunRecord> failed = runs;
  std::erase_if(failed, [](auto& c) { return !c.outcome.expect.starts_with("fail") || is_probe(c); });
  return Columns<RunRecord>{{"", "scene", [](auto& c) { return c.header.scene; }},
                            {"", "solver", label_of},
                            {"", "verdict", [](auto& c) { return c.outcome.expect; }}}
      .table({"Expectations that failed", count_verdicts(runs).text() + ", of those whose scene has a bound.", {}},
             failed);
}

}  // namespace clothbench
