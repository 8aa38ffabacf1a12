#include <set>

#include "base/json_number.hpp"
#include "report/plugin_marks.hpp"
#include "report/report.hpp"
#include "report/verdict.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

/// A run of an exported table (CSV, JSON), with its group.
struct Exported : PlacedRun {
  const Family* family = nullptr;
  const char* source = "measured";
};

Value grid_side(int n) { return n > 0 ? Value(n) : Value(); }

Columns<Exported> solver_columns() {
  return {{"solver", In::Both, [](auto& r) { return r.run->header.solver; }},
          {"setting", In::Both, [](auto& r) { return r.run->header.setting; }},
          {"sides", In::Both, [](auto& r) { return r.series.sides; }}};
}

Columns<Exported> grid_columns() {
  return {{"grid_x", In::Csv, [](auto& r) { return grid_side(r.resolution.grid[0]); }},
          {"grid_y", In::Csv, [](auto& r) { return grid_side(r.resolution.grid[1]); }},
          {"grid", In::Json, [](auto& r) -> Value { return r.resolution.grid; }},
          {"status", In::Both, status_of}};
}

Columns<Exported> table3_columns() {
  Columns<Exported> out = {{"source", In::Csv, &Exported::source}};
  return out.add(solver_columns())
      .add(grid_columns())
      .add({{"failed_frame", In::Both, failed_frame_of},
            {"engine", In::Both, [](auto& r) { return engine_of(*r.run); }}})
      .add(summary_columns<Exported>({"fps_at_72", "fps_median", "fps_spread", "frame_wall_median_s",
                                      "frame_cpu_median_s", "frame_device_median_s", "free_fall_error"}));
}

/// The published values as runs.
std::vector<RunRecord> published_runs(const nlohmann::json& published) {
  std::vector<RunRecord> out;
  for (const nlohmann::json& column : published.at("columns"))
    for (const nlohmann::json& fps : column.at("fps")) {
      out.emplace_back().header.solver = column.at("name").get<std::string>();
      out.back().summary["fps_at_72"] = fps.get<double>();
    }
  return out;
}

}  // namespace

std::string summary_csv(const std::vector<RunRecord>& runs, const std::vector<std::string>& names) {
  Columns<Exported> columns = {{"family", In::Both, [](auto& r) { return r.family->name; }},
                               {"paper_table", In::Both, [](auto& r) { return grid_side(r.family->paper_table); }},
                               {"scene", In::Both, [](auto& r) { return r.run->header.scene; }}};
  columns.add(solver_columns())
      .add({{"repeat", In::Both, [](auto& r) { return r.series.repeat; }},
            {"resolution", In::Both, [](auto& r) { return r.resolution.label(); }}})
      .add(grid_columns())
      .add({{"class", In::Both, [](auto& r) { return r.run->outcome.klass; }},
            {"failed_frame", In::Both, failed_frame_of},
            {"message", In::Both, [](auto& r) { return r.run->outcome.message; }},
            {"expect", In::Both, [](auto& r) { return r.run->outcome.expect; }},
            {"verdict", In::Both, [](auto& r) { return verdict(*r.run); }},
            {"bounds", In::Both, [](auto& r) { return bounds_of(*r.run); }},
            {"probe", In::Both, [](auto& r) { return is_probe(*r.run) ? "yes" : "no"; }}});
  for (const char* key : {"gpu", "driver", "gpu_is_software", "cpu", "protocol", "git_commit", "git_dirty",
                          "source_sha256", "build_type", "clock_policy", "created"})
    columns.push_back({key, In::Both, [key](auto& r) { return environment_of(*r.run, key); }});
  const std::vector<Family> all = families(runs);
  std::vector<Exported> rows;
  for (const Family& f : all)
    for (const PlacedRun& p : f.runs) rows.push_back({p, &f});
  return columns.add(summary_columns<Exported>(names)).csv(rows);
}

std::string runs_csv(const std::vector<RunRecord>& runs) {
  std::set<std::string> names;
  for (const RunRecord& c : runs)
    for (const auto& [name, unused] : c.summary) names.insert(name);
  return summary_csv(runs, {names.begin(), names.end()});
}

std::string table3_csv(const Family& family, const nlohmann::json& published) {
  const std::vector<RunRecord> theirs = published_runs(published);
  const nlohmann::json& widths = published.at("resolution");
  std::vector<Exported> rows;
  for (const RunRecord& c : theirs) {
    const int n = widths.at(rows.size() % widths.size());
    const nlohmann::json& column = published.at("columns").at(rows.size() / widths.size());
    rows.push_back({{&c, {{n, n}, 0}, {"", "", column.value("sides", "")}}, &family, "published"});
  }
  for (const Series& s : family.series())
    for (const Resolution& r : family.resolutions())
      if (const RunRecord* c = family.find(s, r)) rows.push_back({{c, r, s}, &family});
  return table3_columns().csv(rows);
}

nlohmann::json table3_json(const Family& family, const nlohmann::json& published) {
  std::vector<Exported> rows;
  for (const PlacedRun& p : family.runs) rows.push_back({p, &family});
  return {{"published", published}, {"measured", table3_columns().json(rows)}};
}

nlohmann::json runs_json(const std::vector<RunRecord>& runs) {
  nlohmann::json all = nlohmann::json::array();
  for (const RunRecord& c : runs) {
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
                   {"probe", is_probe(c)},
                   {"summary", numbers_to_json(c.summary)},
                   {"withheld", c.withheld},
                   {"environment", c.header.environment}});
  }
  return all;
}

}  // namespace clothbench
