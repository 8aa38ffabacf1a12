#include <fmt/format.h>

#include <map>
#include <set>

#include "base/json_number.hpp"
#include "report/report.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

std::string environment_text(const CellRecord& c, const char* key) {
  const nlohmann::json& e = c.header.environment;
  if (!e.is_object() || !e.contains(key) || e[key].is_null()) return "";
  return e[key].is_string() ? e[key].get<std::string>() : e[key].dump();
}

nlohmann::json versions_of(const CellRecord& c) {
  nlohmann::json out = nlohmann::json::object();
  for (const MetricSeries& m : c.accuracy.metrics) out[m.name] = m.version;
  return out;
}

std::string grid_text(int n) { return n > 0 ? std::to_string(n) : ""; }

const std::vector<std::string> kTable3Names = {"fps_at_72",      "fps_median",          "fps_mean",
                                               "fps_spread",     "frame_wall_median_s", "frame_device_median_s",
                                               "free_fall_error"};

}  // namespace

std::string summary_csv(const std::vector<CellRecord>& cells, const std::vector<std::string>& names) {
  const std::vector<const char*> environment = {"gpu",          "driver",     "gpu_is_software", "cpu",
                                                "protocol",     "git_commit", "git_dirty",       "build_type",
                                                "clock_policy", "created"};
  std::vector<std::string> head = {"family", "paper_table", "scene",        "solver",  "setting",
                                   "sides",  "repeat",      "resolution",   "grid_x",  "grid_y",
                                   "status", "class",       "failed_frame", "message", "expect"};
  head.insert(head.end(), environment.begin(), environment.end());
  head.insert(head.end(), names.begin(), names.end());
  head.emplace_back("withheld");
  std::string out = csv_row(head);
  for (const Family& f : families(cells))
    for (const PlacedCell& p : f.cells) {
      const CellRecord& c = *p.cell;
      std::vector<std::string> row = {f.name,
                                      f.paper_table > 0 ? std::to_string(f.paper_table) : "",
                                      c.header.scene,
                                      c.header.solver,
                                      c.header.setting,
                                      p.series.sides,
                                      std::to_string(p.series.repeat),
                                      p.resolution.label(),
                                      grid_text(p.resolution.grid[0]),
                                      grid_text(p.resolution.grid[1]),
                                      c.outcome.status,
                                      c.outcome.klass,
                                      c.outcome.failed_frame < 0 ? "" : std::to_string(c.outcome.failed_frame),
                                      c.outcome.message,
                                      c.outcome.expect};
      for (const char* key : environment) row.push_back(environment_text(c, key));
      for (const std::string& name : names) row.push_back(csv_number(summary_value(c, name)));
      row.push_back(withheld_of(c, names));
      out += csv_row(row);
    }
  return out;
}

std::string cells_csv(const std::vector<CellRecord>& cells) {
  std::set<std::string> names;
  for (const CellRecord& c : cells)
    for (const auto& [name, unused] : c.summary) names.insert(name);
  return summary_csv(cells, {names.begin(), names.end()});
}

std::string table3_csv(const Family& family, const nlohmann::json& published) {
  std::vector<std::string> head = {"source", "solver", "setting", "sides",
                                   "grid_x", "grid_y", "status",  "failed_frame"};
  head.insert(head.end(), kTable3Names.begin(), kTable3Names.end());
  head.emplace_back("withheld");
  std::string out = csv_row(head);
  const nlohmann::json& resolutions = published.at("resolution");
  for (const nlohmann::json& column : published.at("columns"))
    for (std::size_t k = 0; k < resolutions.size(); ++k) {
      const std::string n = std::to_string(resolutions[k].get<int>());
      std::vector<std::string> row = {"published",
                                      column.at("name").get<std::string>(),
                                      "",
                                      column.value("sides", ""),
                                      n,
                                      n,
                                      "ok",
                                      "",
                                      csv_number(column.at("fps").at(k).get<double>())};
      row.resize(head.size());
      out += csv_row(row);
    }
  for (const Series& s : family.series())
    for (const Resolution& r : family.resolutions()) {
      const CellRecord* c = family.find(s, r);
      if (c == nullptr) continue;
      std::vector<std::string> row = {
          "measured",           c->header.solver,
          c->header.setting,    s.sides,
          grid_text(r.grid[0]), grid_text(r.grid[1]),
          c->outcome.status,    c->outcome.failed_frame < 0 ? "" : std::to_string(c->outcome.failed_frame)};
      for (const std::string& name : kTable3Names) row.push_back(csv_number(summary_value(*c, name)));
      row.push_back(withheld_of(*c, kTable3Names));
      out += csv_row(row);
    }
  return out;
}

nlohmann::json table3_json(const Family& family, const nlohmann::json& published) {
  nlohmann::json measured = nlohmann::json::array();
  for (const PlacedCell& p : family.cells) {
    nlohmann::json row = {{"solver", p.series.solver},
                          {"setting", p.series.setting},
                          {"sides", p.series.sides},
                          {"grid", {p.resolution.grid[0], p.resolution.grid[1]}},
                          {"status", p.cell->outcome.status}};
    if (p.cell->outcome.failed_frame >= 0) row["failed_frame"] = p.cell->outcome.failed_frame;
    for (const std::string& name : kTable3Names) row[name] = number_to_json(summary_value(*p.cell, name));
    if (const std::string why = withheld_of(*p.cell, kTable3Names); !why.empty()) row["withheld"] = why;
    measured.push_back(std::move(row));
  }
  return {{"published", published}, {"measured", measured}};
}

nlohmann::json cells_json(const std::vector<CellRecord>& cells) {
  nlohmann::json all = nlohmann::json::array();
  for (const CellRecord& c : cells) {
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
                   {"summary", numbers_to_json(c.summary)},
                   {"withheld", c.withheld},
                   {"metric_versions", versions_of(c)},
                   {"environment", c.header.environment}});
  }
  return all;
}

}  // namespace clothbench
