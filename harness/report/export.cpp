// CSV and JSON files: runs, series, trials.
#include <fmt/format.h>

#include <numeric>
#include <set>

#include "base/json_text.hpp"
#include "metrics/registry.hpp"
#include "report/report.hpp"
#include "report/web/page.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

json at_least(int least, int n) { return n >= least ? json(n) : json(); }

/// Names and values of one line; null or NaN: missing.
using Fields = std::vector<std::pair<std::string, json>>;
/// A run, or one of its frames or trials.
using Item = std::pair<const Row*, std::size_t>;

/// Numbers in full precision, missing values empty; text with a comma, quote or line break is quoted as in RFC 4180.
std::string csv_field(const json& v) {
  if (v.is_null()) return "";
  if (v.is_number_float()) return std::isnan(v.get<double>()) ? "" : fmt::format("{}", v.get<double>());
  std::string text = v.is_string() ? v.get<std::string>() : dump(v);
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, 1, '"');
  return "\"" + text + "\"";
}

std::string csv(const std::vector<Item>& items, const std::function<Fields(const Row&, std::size_t)>& fields_of) {
  RunRecord none;  // only for the column names
  none.accuracy.time_s = {0};
  none.trials.resize(1);
  std::string out = joined(fields_of(Row{&none}, 0), ",", [](const auto& f) { return csv_field(f.first); });
  for (const auto& [row, index] : items) {
    const Fields fields = fields_of(*row, index);
    out += "\n" + csv_field(fields.front().second);
    for (std::size_t k = 1; k < fields.size(); ++k) out += "," + csv_field(fields[k].second);
  }
  return out + "\n";
}

Fields run_fields(const Row& r) {
  return {{"scene", r.scene}, {"solver", r.solver}, {"setting", r.setting}, {"sides", r.sides}, {"repeat", r.repeat}};
}

}  // namespace

std::string runs_csv(const RunTable& table) {
  std::set<std::string> names;  // every summary value of any run
  for (const RunRecord& c : table.runs())
    for (const auto& [name, unused] : c.summary) names.insert(name);
  std::vector<Item> rows;
  for (const Row& r : table.rows())
    if (r.published < 0) rows.emplace_back(&r, 0);
  // In the order of the result folders.
  std::sort(rows.begin(), rows.end(), [](const Item& a, const Item& b) { return a.first->run < b.first->run; });
  return csv(rows, [&](const Row& r, std::size_t) {
    const Outcome& outcome = r.run->outcome;
    Fields out = run_fields(r);
    out.insert(out.begin(), {{"family", r.family}, {"paper_table", at_least(1, r.paper_table)}});
    out.insert(out.end(), {{"resolution", r.resolution.label()},
                           {"grid_x", at_least(1, r.resolution.grid[0])},
                           {"grid_y", at_least(1, r.resolution.grid[1])},
                           {"status", r.status()},
                           {"class", outcome.klass},
                           {"failed_frame", at_least(0, outcome.failed_frame)},
                           {"message", outcome.message},
                           {"expect", outcome.expect},
                           {"verdict", verdict(*r.run)},
                           {"bounds", bounds_of(*r.run)},
                           {"offset_min_m", r.offset_m().first},
                           {"offset_max_m", r.offset_m().second},
                           {"engine", engine_of(*r.run)}});
    for (const char* key : {"gpu", "driver", "gpu_is_software", "cpu", "protocol", "git_commit", "git_dirty",
                            "source_sha256", "build_type", "clock_policy", "created"})
      out.emplace_back(key, environment_of(*r.run, key));
    for (const std::string& name : names) out.emplace_back(name, r.value(name));
    const auto& withheld = r.run->withheld;
    out.emplace_back("withheld", withheld.empty() ? json() : json(withheld.begin()->second));
    return out;
  });
}

std::string series_csv(const RunTable& table) {
  std::vector<Item> frames;
  for (const Row& r : table.rows())
    for (std::size_t k = 0; r.part == Part::Contact && k < r.run->accuracy.time_s.size(); ++k)
      frames.emplace_back(&r, k);
  return csv(frames, [names = series_columns()](const Row& r, std::size_t k) {
    Fields out = run_fields(r);
    out.emplace_back("time_s", rounded(r.run->accuracy.time_s[k]));
    for (const std::string& name : names) {
      out.emplace_back(name, "");
      for (const MetricSeries& m : r.run->accuracy.metrics)
        if (m.name == name && k < m.values.size()) out.back().second = rounded(m.values[k]);
    }
    return out;
  });
}

std::string trials_csv(const RunTable& table) {
  std::vector<Item> trials;
  for (const Row& r : table.rows())
    for (std::size_t k = 0; k < r.run->trials.size(); ++k) trials.emplace_back(&r, k);
  return csv(trials, [](const Row& r, std::size_t k) {
    const TimedTrial& t = r.run->trials[k];
    Fields out = run_fields(r);
    out.insert(out.end(), {{"trial", t.index},
                           {"frames", t.frames()},
                           {"start_unix_s", t.start_unix_s},
                           {"end_unix_s", t.end_unix_s},
                           {"jobs", t.jobs},
                           {"cpu_clock_Hz", t.cpu_clock_Hz},
                           {"gpu_clock_Hz", t.gpu_clock_Hz},
                           {"temperature_C", t.temperature_C},
                           {"power_W", t.power_W},
                           {"gpu_power_W", t.gpu_power_W},
                           {"pipelined_wall_s", t.pipelined_wall_s}});
    out.emplace_back("not_trusted", environment_of(*r.run, "distrusted_trials")[std::to_string(t.index)]);
    for (const auto& [name, times] :
         {std::pair<std::string, const std::vector<double>&>{"wall", t.frame_wall_s}, {"device", t.frame_device_s}}) {
      const double sum = std::accumulate(times.begin(), times.end(), 0.0);
      std::vector<double> sorted = times;
      std::sort(sorted.begin(), sorted.end());
      out.emplace_back(name + "_mean_s", times.empty() ? json() : json(sum / static_cast<double>(times.size())));
      for (const auto& [which, q] : {std::pair{"p50", 0.5}, {"p95", 0.95}, {"p99", 0.99}, {"max", 1.0}})
        out.emplace_back(fmt::format("{}_{}_s", name, which), nearest_rank(sorted, q));
    }
    return out;
  });
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
