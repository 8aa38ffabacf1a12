// Points of the page's figures.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/json_number.hpp"
#include "base/words.hpp"
#include "metrics/registry.hpp"
#include "report/grid.hpp"
#include "report/report.hpp"
#include "report/web/page.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json six_digits(double v) { return std::isfinite(v) ? json(std::stod(fmt::format("{:.6g}", v))) : json(); }

/// Vertices along one side; of a grid that is no square, the side of the square with as many.
double width_of(const Resolution& r) {
  return std::sqrt(r.grid[0] > 0 ? static_cast<double>(r.grid[0]) * r.grid[1] : static_cast<double>(r.vertices));
}

json published_series(const json& published) {
  json out = json::array();
  for (const json& column : published.at("columns")) {
    json points = json::array();
    for (std::size_t k = 0; k < published.at("resolution").size(); ++k)
      points.push_back({{"width", published["resolution"][k]}, {"fps", column.at("fps").at(k)}});
    out.push_back({{"label", column.at("name")}, {"sides", column.value("sides", "")}, {"points", std::move(points)}});
  }
  return out;
}

json rate_point(const RunRecord& c, const Resolution& r) {
  return {{"width", width_of(r)},
          {"resolution", r.label()},
          {"status", c.outcome.status},
          {"gpu", gpu_of(c)},
          {"fps", finite_or_null(summary_value(c, "fps_median"))},
          {"spread", finite_or_null(summary_value(c, "fps_spread"))},
          {"device_s", finite_or_null(summary_value(c, "frame_device_median_s"))},
          {"read_B_per_s", finite_or_null(summary_value(c, "bandwidth_read_peak_B_per_s"))},
          {"write_B_per_s", finite_or_null(summary_value(c, "bandwidth_write_peak_B_per_s"))},
          {"window_s", finite_or_null(summary_value(c, "bandwidth_window_s"))},
          {"stretch_max", finite_or_null(summary_value(c, "stretch_max_last_second"))},
          {"stretch_mean", finite_or_null(summary_value(c, "stretch_mean_last_second"))}};
}

json contact_row(const ContactRow& r) {
  const RunRecord& c = *r.run;
  json time_s = json::array(), series = json::object();
  for (const double t : c.accuracy.time_s) time_s.push_back(six_digits(t));
  for (const MetricSeries& m : c.accuracy.metrics) {
    const auto drawn = std::find_if(metrics().begin(), metrics().end(),
                                    [&](const Metric& d) { return d.drawn.place > 0 && d.name == m.name; });
    if (drawn == metrics().end()) continue;
    if (std::none_of(m.values.begin(), m.values.end(), [](double v) { return std::isfinite(v); })) continue;
    json values = json::array();
    for (const double v : m.values) values.push_back(six_digits(v));
    series[m.name] = {{"units", m.units},
                      {"long_name", m.long_name},
                      {"words", drawn->drawn.words},
                      {"place", drawn->drawn.place},
                      {"values", std::move(values)}};
  }
  return {{"label", r.series.label()},   {"solver", r.series.solver},   {"setting", r.series.setting},
          {"sides", r.series.sides},     {"status", c.outcome.status},  {"failed_frame", c.outcome.failed_frame},
          {"time_s", std::move(time_s)}, {"metrics", std::move(series)}};
}

}  // namespace

json rates_json(const std::vector<Family>& all, const json& published) {
  json out = json::array();
  for (const Family& f : all) {
    json series = json::array();
    for (const Series& s : f.series()) {
      json points = json::array();
      for (const Resolution& r : f.resolutions())
        if (const RunRecord* c = f.find(s, r)) points.push_back(rate_point(*c, r));
      series.push_back({{"label", s.label()},
                        {"solver", s.solver},
                        {"setting", s.setting},
                        {"sides", s.sides},
                        {"points", std::move(points)}});
    }
    out.push_back({{"name", f.name}, {"paper_table", f.paper_table}, {"series", std::move(series)}});
    if (f.paper_table == 3) out.back()["published"] = published_series(published);
  }
  return out;
}

json contact_series_json(const std::vector<ContactSetUp>& ups) {
  json out = json::array();
  for (const ContactSetUp& u : ups) {
    json scenes = json::array();
    for (const ContactScene& s : u.scenes) {
      json rows = json::array();
      for (const ContactRow& r : s.rows) rows.push_back(contact_row(r));
      scenes.push_back({{"name", s.name}, {"rows", std::move(rows)}});
    }
    out.push_back({{"kind", u.kind}, {"title", u.title}, {"scenes", std::move(scenes)}});
  }
  return out;
}

Table environment_table(const std::vector<RunRecord>& runs) {
  static constexpr std::pair<const char*, const char*> kKeys[] = {{"gpu", "GPU"},
                                                                  {"gpu_is_software", "GPU is software"},
                                                                  {"device_profile", "device profile"},
                                                                  {"driver", "driver"},
                                                                  {"cpu", "CPU"},
                                                                  {"shader_compiler", "shader compiler"},
                                                                  {"clock_policy", "clocks"},
                                                                  {"protocol", "protocol"},
                                                                  {"git_commit", "commit"},
                                                                  {"git_dirty", "local changes"},
                                                                  {"source_sha256", "sources"},
                                                                  {"build_type", "build"},
                                                                  {"assets", "assets"}};
  const auto text = [](const json& v) -> std::string {
    if (v.is_boolean()) return v.get<bool>() ? "Yes" : "No";  // facts, not verdicts: the page colours yes and no
    return v.is_string() && !v.get<std::string>().empty() ? v.get<std::string>()
           : v.is_null() || v.is_string()                 ? "–"
                                                          : v.dump();
  };
  struct Place {
    std::vector<std::string> what;
    std::size_t runs;
    std::set<std::string> solvers;
  };
  std::vector<Place> places;
  for (const RunRecord& c : runs) {
    if (!c.header.environment.is_object() || c.header.environment.empty()) continue;
    std::vector<std::string> place;
    for (const auto& [key, label] : kKeys) place.push_back(text(environment_of(c, key)));
    const auto same = std::find_if(places.begin(), places.end(), [&](const Place& p) { return p.what == place; });
    Place& here = same == places.end() ? places.emplace_back(Place{place, 0, {}}) : *same;
    ++here.runs;
    here.solvers.insert(c.header.solver);
  }
  Table t{"Machines of the runs", "As stated in each result file.", {{"what"}}};
  for (const Place& p : places)
    t.rows[0].push_back(fmt::format("{} ({} run{})", fmt::join(p.solvers, ", "), p.runs, p.runs == 1 ? "" : "s"));
  for (std::size_t k = 0; k < std::size(kKeys); ++k) {
    std::vector<std::string> row = {kKeys[k].second};
    for (const Place& p : places) row.push_back(p.what[k]);
    if (std::any_of(row.begin() + 1, row.end(), [](const std::string& s) { return s != "–"; }))
      t.rows.push_back(std::move(row));
  }
  return t;
}

std::vector<std::string> commands_of(const std::vector<fs::path>& results) {
  std::vector<std::string> out;
  for (const fs::path& result : results) {
    if (!fs::exists(result / "study.json")) continue;
    std::string line = read_manifest(result).command_line;
    if (!line.empty() && !contains(out, line)) out.push_back(std::move(line));
  }
  return out;
}

}  // namespace clothbench
