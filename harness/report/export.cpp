// CSV and JSON: runs, series, trials.
#include <fmt/format.h>

#include <cmath>
#include <set>

#include "base/columns.hpp"
#include "base/json_number.hpp"
#include "metrics/registry.hpp"
#include "report/report.hpp"
#include "report/verdict.hpp"

namespace clothbench {
namespace {

Value grid_side(int n) { return n > 0 ? Value(n) : Value(); }

std::string six_digits(double v) { return std::isfinite(v) ? fmt::format("{:.6g}", v) : ""; }

/// A run, and a frame or trial of it; R has the members `row` and, for the last two, `index`.
struct Item {
  const Row* row;
  std::size_t index = 0;
};

Columns<Item> run_columns() {
  return {{"scene", In::Both, [](auto& i) { return i.row->scene; }},
          {"solver", In::Both, [](auto& i) { return i.row->solver; }},
          {"setting", In::Both, [](auto& i) { return i.row->setting; }},
          {"sides", In::Both, [](auto& i) { return i.row->sides; }},
          {"repeat", In::Both, [](auto& i) { return i.row->repeat; }}};
}

/// Every summary value that a run has.
std::set<std::string> summary_names(const RunTable& table) {
  std::set<std::string> out;
  for (const RunRecord& c : table.runs())
    for (const auto& [name, unused] : c.summary) out.insert(name);
  return out;
}

std::vector<double> sorted(std::vector<double> s) {
  std::sort(s.begin(), s.end());
  return s;
}

}  // namespace

std::string runs_csv(const RunTable& table) {
  Columns<Item> columns = {{"family", In::Both, [](auto& i) { return i.row->family; }},
                           {"paper_table", In::Both, [](auto& i) { return grid_side(i.row->paper_table); }}};
  columns.add(run_columns())
      .add({{"resolution", In::Both, [](auto& i) { return i.row->resolution.label(); }},
            {"grid_x", In::Both, [](auto& i) { return grid_side(i.row->resolution.grid[0]); }},
            {"grid_y", In::Both, [](auto& i) { return grid_side(i.row->resolution.grid[1]); }},
            {"status", In::Both, [](auto& i) { return i.row->status(); }},
            {"class", In::Both, [](auto& i) { return i.row->run->outcome.klass; }},
            {"failed_frame", In::Both,
             [](auto& i) {
               const int frame = i.row->run->outcome.failed_frame;
               return frame < 0 ? Value() : Value(frame);
             }},
            {"message", In::Both, [](auto& i) { return i.row->run->outcome.message; }},
            {"expect", In::Both, [](auto& i) { return i.row->run->outcome.expect; }},
            {"verdict", In::Both, [](auto& i) { return verdict(*i.row->run); }},
            {"bounds", In::Both, [](auto& i) { return bounds_of(*i.row->run); }},
            {"offset_min_m", In::Both, [](auto& i) { return i.row->offset_m().first; }},
            {"offset_max_m", In::Both, [](auto& i) { return i.row->offset_m().second; }},
            {"engine", In::Both, [](auto& i) { return engine_of(*i.row->run); }}});
  for (const char* key : {"gpu", "driver", "gpu_is_software", "cpu", "protocol", "git_commit", "git_dirty",
                          "source_sha256", "build_type", "clock_policy", "created"})
    columns.push_back({key, In::Both, [key](auto& i) { return environment_of(*i.row->run, key); }});
  for (const std::string& name : summary_names(table))
    columns.push_back({name, In::Both, [name](auto& i) { return i.row->value(name); }});
  columns.push_back({"withheld", In::Both, [](auto& i) {
                       const auto& withheld = i.row->run->withheld;
                       return withheld.empty() ? Value() : Value(withheld.begin()->second);
                     }});
  std::vector<Item> rows;
  for (const Row& r : table.rows())
    if (r.published < 0) rows.push_back({&r});
  // In the order of the folders.
  std::sort(rows.begin(), rows.end(), [](const Item& a, const Item& b) { return a.row->run < b.row->run; });
  return columns.csv(rows);
}

std::string series_csv(const RunTable& table) {
  Columns<Item> columns = run_columns();
  columns.push_back({"time_s", In::Both, [](auto& i) { return six_digits(i.row->run->accuracy.time_s[i.index]); }});
  for (const std::string& name : series_columns())
    columns.push_back({name, In::Both, [name](auto& i) -> Value {
                         for (const MetricSeries& m : i.row->run->accuracy.metrics)
                           if (m.name == name && i.index < m.values.size()) return six_digits(m.values[i.index]);
                         return "";
                       }});
  std::vector<Item> frames;
  for (const Row& r : table.rows())
    for (std::size_t k = 0; r.part == Part::Contact && k < r.run->accuracy.time_s.size(); ++k)
      frames.push_back({&r, k});
  return columns.csv(frames);
}

std::string trials_csv(const RunTable& table) {
  static const auto trial = [](const Item& i) -> const TimedTrial& { return i.row->run->trials[i.index]; };
  Columns<Item> columns = run_columns();
  columns.add({{"trial", In::Both, [](auto& i) { return trial(i).index; }},
               {"frames", In::Both, [](auto& i) { return trial(i).frames(); }},
               {"start_unix_s", In::Both, [](auto& i) { return trial(i).start_unix_s; }},
               {"jobs", In::Both, [](auto& i) { return trial(i).jobs; }},
               {"pipelined_wall_s", In::Both, [](auto& i) { return trial(i).pipelined_wall_s; }}});
  for (const auto& [name, series] :
       {std::pair{"wall", &TimedTrial::frame_wall_s}, {"device", &TimedTrial::frame_device_s}}) {
    columns.push_back({fmt::format("{}_mean_s", name), In::Both, [series = series](auto& i) -> Value {
                         const std::vector<double>& s = trial(i).*series;
                         double sum = 0;
                         for (const double x : s) sum += x;
                         return s.empty() ? Value() : Value(sum / static_cast<double>(s.size()));
                       }});
    for (const auto& [which, q] : {std::pair{"p50", 0.5}, {"p95", 0.95}, {"p99", 0.99}, {"max", 1.0}})
      columns.push_back({fmt::format("{}_{}_s", name, which), In::Both,
                         [series = series, q = q](auto& i) { return Value(quantile(sorted(trial(i).*series), q)); }});
  }
  std::vector<Item> trials;
  for (const Row& r : table.rows())
    for (std::size_t k = 0; k < r.run->trials.size(); ++k) trials.push_back({&r, k});
  return columns.csv(trials);
}

nlohmann::json runs_json(const std::vector<RunRecord>& runs) {
  nlohmann::json all = nlohmann::json::array();
  for (const RunRecord& c : runs)
    all.push_back({{"scene", c.header.scene},
                   {"solver", c.header.solver},
                   {"setting", c.header.setting},
                   {"settings", c.header.settings},
                   {"scenario_sha256", c.header.scenario_sha256},
                   {"outcome",
                    {{"status", c.outcome.status},
                     {"class", c.outcome.klass},
                     {"failed_frame", c.outcome.failed_frame},
                     {"message", c.outcome.message},
                     {"expect", c.outcome.expect}}},
                   {"verdict", verdict(c)},
                   {"bounds", bounds_of(c)},
                   {"summary", numbers_to_json(c.summary)},
                   {"withheld", c.withheld},
                   {"environment", c.header.environment}});
  return all;
}

}  // namespace clothbench
