#pragma once
#include <fmt/format.h>

#include <string>
#include <vector>

#include "report/report.hpp"
#include "report/view.hpp"

namespace clothbench {

/// A run of the paper's gravity scene, as the runner stores it.
inline RunRecord fake_run(const std::string& solver, int n, const std::string& sides, double frame_s,
                          bool on_gpu = true) {
  RunRecord c;
  c.header.scene = fmt::format("gravity-{}-{}", n, sides);
  c.header.solver = solver;
  c.header.setting = "default";
  c.header.settings = nlohmann::json::object();
  c.header.scenario_json =
      fmt::format(R"({{"name":"gravity","paper":{{"table":3}},"cloth":{{"grid":[{},{}],"sides":"{}"}}}})", n, n, sides);
  c.header.environment = {{"gpu", on_gpu ? "Fake GPU" : "CPU"},
                          {"driver", "1.2"},
                          {"gpu_is_software", false},
                          {"cpu", "Fake CPU"},
                          {"protocol", "short"},
                          {"git_commit", "0123456789abcdef"},
                          {"git_dirty", false},
                          {"build_type", "Release"},
                          {"created", "2026-01-01T00:00:00Z"}};
  c.summary = {{"fps_median", 1 / frame_s},
               {"fps_at_72", 1 / frame_s < 72 ? 1 / frame_s : 72},
               {"frame_wall_median_s", frame_s},
               {"frame_device_median_s", on_gpu ? 0.9 * frame_s : kMissing},
               {"free_fall_error", 1.24e-6},
               {"read_B_per_frame", on_gpu ? 2000.0 * n : kMissing},
               {"write_B_per_frame", on_gpu ? 1000.0 * n : kMissing},
               {"bandwidth_read_peak_B_per_s", on_gpu ? 4e9 : kMissing},
               {"bandwidth_write_peak_B_per_s", on_gpu ? 2e9 : kMissing},
               {"bandwidth_window_s", 0.5},
               {"device_memory_B", on_gpu ? 8992.0 : kMissing},
               {"dispatches", on_gpu ? 14.0 : kMissing},
               {"load_s", 0.01},
               {"jobs", 1}};
  return c;
}

inline RunRecord with_outcome(RunRecord c, const std::string& status, int frame, const std::string& message) {
  c.outcome = {status, status == "diverged" ? "F1" : "ok", frame, message};
  c.summary.clear();
  return c;
}

/// The cell under the heading `column` in the row that starts with these cells; "" if there is none.
inline std::string entry(const Table& t, const std::vector<std::string>& start, const std::string& column) {
  for (std::size_t k = 0; k < t.rows.at(0).size(); ++k)
    for (const auto& row : t.rows)
      if (t.rows[0][k] == column && std::equal(start.begin(), start.end(), row.begin())) return row.at(k);
  return "";
}
inline std::string entry(const Table& t, const std::string& first, const std::string& second,
                         const std::string& column) {
  return entry(t, {first, second}, column);
}
inline std::string entry(const Table& t, const std::string& first, const std::string& column) {
  return entry(t, std::vector{first}, column);
}

/// All tables of a report of these runs with the view's title; empty if there are none.
inline std::vector<Table> tables_titled(const std::vector<RunRecord>& runs, const std::string& title) {
  const RunTable table(runs);
  for (const View& v : views())
    if (v.title == title) {
      const std::vector<ViewTable> found = tables_of(v, table);
      return {found.begin(), found.end()};
    }
  throw std::runtime_error("no view has the title " + title);
}

/// The first of these tables; an empty one if there is none.
inline Table table_of(const std::vector<RunRecord>& runs, const std::string& title) {
  const std::vector<Table> all = tables_titled(runs, title);
  return all.empty() ? Table{"", "", {{}}} : all.front();
}

/// Records of CSV text as RFC 4180 reads them.
inline std::vector<std::vector<std::string>> parse_csv(const std::string& text) {
  std::vector<std::vector<std::string>> rows(1, {""});
  bool quoted = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (quoted && c == '"' && k + 1 < text.size() && text[k + 1] == '"')
      rows.back().back() += text[++k];
    else if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      rows.back().emplace_back();
    else if (c == '\n' && !quoted)
      rows.push_back({""});
    else
      rows.back().back() += c;
  }
  rows.pop_back();  // after the last line break
  return rows;
}

/// The value of a row in the column of this name; "no column" if there is none.
inline std::string field(const std::vector<std::vector<std::string>>& csv, std::size_t row, const std::string& name) {
  for (std::size_t k = 0; k < csv.at(0).size(); ++k)
    if (csv[0][k] == name) return csv.at(row).at(k);
  return "no column";
}

/// The study table3 at two resolutions.
inline std::vector<RunRecord> study() {
  std::vector<RunRecord> runs;
  for (const int n : {128, 8}) {
    runs.push_back(fake_run("xpbd", n, "double", n == 8 ? 2e-4 : 0.0217));
    runs.push_back(fake_run("xpbd", n, "single", n == 8 ? 1e-4 : 0.02));
    runs.push_back(fake_run("bullet-soft", n, "single", 1e-3, false));
    runs.push_back(fake_run("ballistic", n, "single", n == 8 ? 1e-7 : 4e-5, false));
  }
  return runs;
}

}  // namespace clothbench
