// CSV and JSON: runs, series, trials.
#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <set>

#include "base/json_number.hpp"
#include "metrics/registry.hpp"
#include "report/report.hpp"
#include "report/verdict.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

json at_least(int least, int n) { return n >= least ? json(n) : json(); }

std::string six_digits(double v) { return std::isfinite(v) ? fmt::format("{:.6g}", v) : ""; }

/// A run, or a frame or trial of it.
struct Item {
  const Row* row;
  std::size_t index = 0;
};

struct Column {
  std::string name;
  std::function<json(const Item&)> value;  ///< null or NaN: missing
};
using Columns = std::vector<Column>;

/// Numbers in full precision, missing values empty; text with a comma, quote or line break is quoted as in RFC 4180.
std::string csv_field(const json& v) {
  if (v.is_null()) return "";
  if (v.is_number_float()) return std::isnan(v.get<double>()) ? "" : fmt::format("{}", v.get<double>());
  std::string text = v.is_string() ? v.get<std::string>() : v.dump();
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, 1, '"');
  return "\"" + text + "\"";
}

std::string csv(const Columns& columns, const std::vector<Item>& items) {
  std::string out;
  const auto add_row = [&](const auto& field) {
    for (const Column& c : columns) out += (&c == &columns.front() ? "" : ",") + csv_field(field(c));
    out += "\n";
  };
  add_row([](const Column& c) { return json(c.name); });
  for (const Item& i : items) add_row([&](const Column& c) { return c.value(i); });
  return out;
}

void append(Columns& to, const Columns& more) { to.insert(to.end(), more.begin(), more.end()); }

Columns run_columns() {
  return {{"scene", [](auto& i) { return i.row->scene; }},
          {"solver", [](auto& i) { return i.row->solver; }},
          {"setting", [](auto& i) { return i.row->setting; }},
          {"sides", [](auto& i) { return i.row->sides; }},
          {"repeat", [](auto& i) { return i.row->repeat; }}};
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
  Columns columns = {{"family", [](auto& i) { return i.row->family; }},
                     {"paper_table", [](auto& i) { return at_least(1, i.row->paper_table); }}};
  append(columns, run_columns());
  append(columns, {{"resolution", [](auto& i) { return i.row->resolution.label(); }},
                   {"grid_x", [](auto& i) { return at_least(1, i.row->resolution.grid[0]); }},
                   {"grid_y", [](auto& i) { return at_least(1, i.row->resolution.grid[1]); }},
                   {"status", [](auto& i) { return i.row->status(); }},
                   {"class", [](auto& i) { return i.row->run->outcome.klass; }},
                   {"failed_frame", [](auto& i) { return at_least(0, i.row->run->outcome.failed_frame); }},
                   {"message", [](auto& i) { return i.row->run->outcome.message; }},
                   {"expect", [](auto& i) { return i.row->run->outcome.expect; }},
                   {"verdict", [](auto& i) { return verdict(*i.row->run); }},
                   {"bounds", [](auto& i) { return bounds_of(*i.row->run); }},
                   {"offset_min_m", [](auto& i) { return i.row->offset_m().first; }},
                   {"offset_max_m", [](auto& i) { return i.row->offset_m().second; }},
                   {"engine", [](auto& i) { return engine_of(*i.row->run); }}});
  for (const char* key : {"gpu", "driver", "gpu_is_software", "cpu", "protocol", "git_commit", "git_dirty",
                          "source_sha256", "build_type", "clock_policy", "created"})
    columns.push_back({key, [key](auto& i) { return environment_of(*i.row->run, key); }});
  for (const std::string& name : summary_names(table))
    columns.push_back({name, [name](auto& i) { return i.row->value(name); }});
  columns.push_back({"withheld", [](auto& i) {
                       const auto& withheld = i.row->run->withheld;
                       return withheld.empty() ? json() : json(withheld.begin()->second);
                     }});
  std::vector<Item> rows;
  for (const Row& r : table.rows())
    if (r.published < 0) rows.push_back({&r});
  // In the order of the folders.
  std::sort(rows.begin(), rows.end(), [](const Item& a, const Item& b) { return a.row->run < b.row->run; });
  return csv(columns, rows);
}

std::string series_csv(const RunTable& table) {
  Columns columns = run_columns();
  columns.push_back({"time_s", [](auto& i) { return six_digits(i.row->run->accuracy.time_s[i.index]); }});
  for (const std::string& name : series_columns())
    columns.push_back({name, [name](auto& i) -> json {
                         for (const MetricSeries& m : i.row->run->accuracy.metrics)
                           if (m.name == name && i.index < m.values.size()) return six_digits(m.values[i.index]);
                         return "";
                       }});
  std::vector<Item> frames;
  for (const Row& r : table.rows())
    for (std::size_t k = 0; r.part == Part::Contact && k < r.run->accuracy.time_s.size(); ++k)
      frames.push_back({&r, k});
  return csv(columns, frames);
}

std::string trials_csv(const RunTable& table) {
  static const auto trial = [](const Item& i) -> const TimedTrial& { return i.row->run->trials[i.index]; };
  Columns columns = run_columns();
  append(columns, {{"trial", [](auto& i) { return trial(i).index; }},
                   {"frames", [](auto& i) { return trial(i).frames(); }},
                   {"start_unix_s", [](auto& i) { return trial(i).start_unix_s; }},
                   {"jobs", [](auto& i) { return trial(i).jobs; }},
                   {"pipelined_wall_s", [](auto& i) { return trial(i).pipelined_wall_s; }}});
  for (const auto& [name, series] :
       {std::pair{"wall", &TimedTrial::frame_wall_s}, {"device", &TimedTrial::frame_device_s}}) {
    columns.push_back({fmt::format("{}_mean_s", name), [series = series](auto& i) -> json {
                         const std::vector<double>& s = trial(i).*series;
                         const double sum = std::accumulate(s.begin(), s.end(), 0.0);
                         return s.empty() ? json() : json(sum / static_cast<double>(s.size()));
                       }});
    for (const auto& [which, q] : {std::pair{"p50", 0.5}, {"p95", 0.95}, {"p99", 0.99}, {"max", 1.0}})
      columns.push_back({fmt::format("{}_{}_s", name, which),
                         [series = series, q = q](auto& i) { return json(quantile(sorted(trial(i).*series), q)); }});
  }
  std::vector<Item> trials;
  for (const Row& r : table.rows())
    for (std::size_t k = 0; k < r.run->trials.size(); ++k) trials.push_back({&r, k});
  return csv(columns, trials);
}

json runs_json(const std::vector<RunRecord>& runs) {
  json all = json::array();
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
