#include "report/web/page.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/files.hpp"
#include "base/json_number.hpp"
#include "clothbench/error.hpp"
#include "metrics/registry.hpp"
#include "report/verdict.hpp"
#include "report/view.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr char kDataMark[] = "<!--clothbench:data-->";

/// Summary values that a figure shows.
constexpr const char* kFigureValues[] = {"fps_median",
                                         "fps_spread",
                                         "frame_device_median_s",
                                         "bandwidth_read_peak_B_per_s",
                                         "bandwidth_write_peak_B_per_s",
                                         "bandwidth_window_s",
                                         "stretch_max_last_second",
                                         "stretch_mean_last_second"};
constexpr const char* kParts[] = {"rates", "contact", "generated", "accuracy", "stability", ""};

json table_json(const Table& t) {
  return {{"title", t.title}, {"note", t.note}, {"rows", t.rows}, {"markdown", t.markdown()}, {"latex", t.latex()}};
}

json rounded(double v) { return std::isfinite(v) ? json(std::stod(fmt::format("{:.6g}", v))) : json(); }

/// Vertices along one side; for a grid that is no square, the side of the square with as many.
double width_of(const Resolution& r) { return std::sqrt(r.size()); }

json figure_row(const Row& r) {
  json out = {{"part", kParts[static_cast<int>(r.part)]},
              {"scene", r.scene},
              {"family", r.family},
              {"paper_table", r.paper_table},
              {"published", r.published >= 0},
              {"solver", r.solver},
              {"setting", r.setting},
              {"label", r.label()},
              {"sides", r.sides},
              {"set_up", r.set_up},
              {"width", width_of(r.resolution)},
              {"resolution", r.resolution.label()},
              {"status", r.status()},
              {"verdict", verdict(*r.run)},
              {"gpu", gpu_of(*r.run)}};
  if (r.part == Part::Rates) {
    for (const char* name : kFigureValues) out[name] = finite_or_null(r.value(name));
    if (r.published >= 0) out["fps_median"] = r.value("fps_at_72");
  }
  if (r.part == Part::Stability) {
    out["case"] = case_of(r);
    out["grade"] = grade_of(r);
  }
  if (r.part != Part::Truth) return out;
  out["wall_ms_per_s"] = finite_or_null(r.wall_ms_per_s());
  out["device_ms_per_s"] = finite_or_null(r.device_ms_per_s());
  out["error"] = finite_or_null(r.error());
  out["not_ranked"] = r.not_ranked();
  out["ranking"] = r.truth->ranking;
  out["space_error"] = finite_or_null(r.truth->space_error);
  out["reference_uncertainty"] = finite_or_null(r.truth->uncertainty);
  out["refused"] = r.truth->refused();
  return out;
}

/// Text inside a script element ends at "</script" or changes its meaning at "<!--": neither is left.
std::string script_safe(const std::string& json_text) {
  std::string out;
  out.reserve(json_text.size());
  for (const char c : json_text)
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  return out;
}

}  // namespace

json figure_rows(const RunTable& table) {
  json out = json::array();
  for (const Row& r : table.rows()) out.push_back(figure_row(r));
  return out;
}

json figure_series(const RunTable& table) {
  json out = json::array();
  for (std::size_t k = 0; k < table.rows().size(); ++k) {
    const Row& r = table.rows()[k];
    if (r.part != Part::Contact) continue;
    json time_s = json::array(), series = json::object();
    for (const double t : r.run->accuracy.time_s) time_s.push_back(rounded(t));
    for (const MetricSeries& m : r.run->accuracy.metrics) {
      const auto drawn = std::find_if(metrics().begin(), metrics().end(),
                                      [&](const Metric& d) { return d.drawn.place > 0 && d.name == m.name; });
      if (drawn == metrics().end()) continue;
      if (std::none_of(m.values.begin(), m.values.end(), [](double v) { return std::isfinite(v); })) continue;
      json values = json::array();
      for (const double v : m.values) values.push_back(rounded(v));
      series[m.name] = {{"units", m.units},
                        {"words", drawn->drawn.words},
                        {"place", drawn->drawn.place},
                        {"values", std::move(values)}};
    }
    out.push_back({{"run", k}, {"time_s", std::move(time_s)}, {"metrics", std::move(series)}});
  }
  return out;
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

json page_document(const RunTable& table, const Page& page, const Motions& motions) {
  json shown = json::array();
  for (const PageSection& s : page.sections) {
    json tables = json::array();
    for (const Table& t : s.tables) tables.push_back(table_json(t));
    shown.push_back({{"id", s.id}, {"title", s.title}, {"tables", std::move(tables)}});
  }
  return {{"format", "clothbench-report"}, {"format_version", 1},        {"headline", page.headline},
          {"sections", std::move(shown)},  {"runs", figure_rows(table)}, {"series", figure_series(table)},
          {"commands", page.commands},     {"solvers", solver_roles()},  {"motions", motions.document}};
}

std::string page_html(const std::string& html, const json& document, const std::vector<std::string>& blobs) {
  const std::size_t at = html.find(kDataMark);
  if (at == std::string::npos)
    throw Error("the page's template has no place for the data; build clothbench again", ExitCode::CheckFailed);
  std::string data = "<script type=\"application/json\" id=\"clothbench-data\">" +
                     script_safe(document.dump(-1, ' ', true, json::error_handler_t::replace)) + "</script>\n";
  for (std::size_t k = 0; k < blobs.size(); ++k)
    data += "<script type=\"text/plain\" id=\"blob-" + std::to_string(k) + "\">" + blobs[k] + "</script>\n";
  return html.substr(0, at) + data + html.substr(at + sizeof kDataMark - 1);
}

#ifdef CLOTHBENCH_WITH_PAGE
std::string write_page(const fs::path& out, const RunTable& table, const Page& page, const PageTemplate& from) {
  if (from.html.empty()) {
    fs::remove(out / "index.html");  // an older run's page is not this report's
    return "The interactive page was left out: " + from.missing + ".";
  }
  const Motions motions = motions_of(table.runs());
  write_file_atomically(out / "index.html", page_html(from.html, page_document(table, page, motions), motions.blobs));
  return "";
}
#else
PageTemplate page_template() { return {}; }

std::string write_page(const fs::path& out, const RunTable&, const Page&, const PageTemplate&) {
  fs::remove(out / "index.html");  // an older run's page is not this report's
  return "The interactive page was left out: this build was made without it (CLOTHBENCH_WITH_PAGE).";
}
#endif

}  // namespace clothbench
