#include "report/grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace clothbench {
namespace {

/// Row and column of a run, and `family`: its scene without resolution and sides.
struct Parsed {
  Resolution resolution;
  std::string sides, name, family;
  int paper_table = 0;
};

Parsed parse(const RunRecord& c) {
  Parsed p;
  p.name = c.header.scene;
  nlohmann::json s = scenario_of(c);
  if (!s.is_object()) {
    p.family = "\n" + p.name;  // no scene's JSON starts with a line break
    return p;
  }
  if (s.contains("name") && s["name"].is_string()) p.name = s["name"].get<std::string>();
  const nlohmann::json table = s.value(nlohmann::json::json_pointer("/paper/table"), nlohmann::json());
  if (table.is_number_integer()) p.paper_table = table;
  if (nlohmann::json& cloth = s["cloth"]; cloth.is_object()) {
    const nlohmann::json grid = cloth.value("grid", nlohmann::json());
    if (grid.is_array() && grid.size() == 2 && grid[0].is_number_integer() && grid[1].is_number_integer()) {
      p.resolution.grid[0] = grid[0];
      p.resolution.grid[1] = grid[1];
    }
    if (cloth.contains("sides") && cloth["sides"].is_string()) p.sides = cloth["sides"].get<std::string>();
    cloth.erase("grid");
    cloth.erase("sides");
  }
  if (p.resolution.grid[0] == 0) p.resolution.vertices = c.header.vertices;
  p.family = s.dump();
  return p;
}

int rank(const std::string& sides) { return sides == "single" ? 0 : sides == "double-duplicated" ? 1 : 2; }

}  // namespace

double summary_value(const RunRecord& c, const std::string& name) {
  const auto at = c.summary.find(name);
  return at == c.summary.end() ? kMissing : at->second;
}

nlohmann::json scenario_of(const RunRecord& c) { return nlohmann::json::parse(c.header.scenario_json, nullptr, false); }

nlohmann::json environment_of(const RunRecord& c, const char* key) {
  const nlohmann::json& e = c.header.environment;
  return e.is_object() ? e.value(key, nlohmann::json()) : nlohmann::json();
}

bool has_block(const RunRecord& c, const char* name) {
  const nlohmann::json s = scenario_of(c);
  return s.is_object() && s.contains(name);
}

std::string base_name(const RunRecord& c) {
  const nlohmann::json j = scenario_of(c);
  return j.is_object() && j.contains("name") && j["name"].is_string() ? j["name"].get<std::string>() : c.header.scene;
}

Columns<TextRow> text_columns(const std::vector<std::string>& heads, const std::vector<std::string>& across) {
  Columns<TextRow> out = {{"", heads.front(), &TextRow::name}};
  for (std::size_t k = 0; k + 1 < heads.size(); ++k)
    out.push_back({"", heads[k + 1], [k](auto& r) { return k < r.more.size() ? Value(r.more[k]) : Value(); }});
  return out.across(across, std::identity{}, [](const TextRow& r, const std::string& column) {
    const auto at = r.cells.find(column);
    return at == r.cells.end() ? "" : at->second;
  });
}

std::vector<double> trial_means(const RunRecord& c) {
  std::vector<double> out;
  for (const TimedTrial& t : c.trials) {
    double sum = 0;
    for (const double w : t.frame_wall_s) sum += w;
    if (t.frames() > 0 && sum > 0) out.push_back(sum / t.frames());
  }
  std::sort(out.begin(), out.end());
  return out;
}

double middle(const std::vector<double>& sorted) {
  const std::size_t n = sorted.size();
  return (sorted[(n - 1) / 2] + sorted[n / 2]) / 2;
}

std::string ending(const Outcome& o) {
  return o.failed_frame < 0 ? o.status : fmt::format("{} at {}", o.status, o.failed_frame);
}

std::string status_with_class(const Outcome& o) {
  return o.status + (o.klass.empty() || o.klass == "ok" ? "" : " (" + o.klass + ")");
}

std::string or_dash(const std::string& text) { return text.empty() ? "–" : text; }

std::string label_of(const RunRecord& c) { return Series{c.header.solver, c.header.setting, ""}.label(); }

std::string Resolution::label() const {
  if (grid[0] > 0) return grid[0] == grid[1] ? fmt::format("{}²", grid[0]) : fmt::format("{}×{}", grid[0], grid[1]);
  return vertices > 0 ? fmt::format("{} vertices", vertices) : "–";
}

std::string Series::label() const {
  std::string out = setting == "default" || setting.empty() ? solver : solver + " " + setting;
  return repeat > 1 ? fmt::format("{} ({})", out, repeat) : out;
}

std::vector<Resolution> Family::resolutions() const {
  std::set<Resolution> all;
  for (const PlacedRun& p : runs) all.insert(p.resolution);
  std::vector<Resolution> out(all.begin(), all.end());
  std::stable_sort(out.begin(), out.end(), [](const Resolution& a, const Resolution& b) {
    const auto size = [](const Resolution& r) { return static_cast<double>(r.grid[0]) * r.grid[1] + r.vertices; };
    return size(a) < size(b);
  });
  return out;
}

std::vector<Series> Family::series() const {
  std::set<Series> all;
  for (const PlacedRun& p : runs) all.insert(p.series);
  std::vector<Series> out(all.begin(), all.end());
  std::stable_sort(out.begin(), out.end(), [](const Series& a, const Series& b) {
    const auto order = [](const Series& s) { return std::tuple(s.solver, s.setting, s.repeat, rank(s.sides)); };
    return order(a) < order(b);
  });
  return out;
}

const RunRecord* Family::find(const Series& s, const Resolution& r) const {
  for (const PlacedRun& p : runs)
    if (p.series == s && p.resolution == r) return p.run;
  return nullptr;
}

std::string Family::cell(const Series& s, const Resolution& r,
                         const std::function<std::string(const RunRecord&)>& text) const {
  const RunRecord* c = find(s, r);
  return c == nullptr ? "" : c->outcome.status == "ok" ? text(*c) : ending(c->outcome);
}

Table Family::table(const std::string& title, const std::string& note,
                    const std::function<std::string(const RunRecord&)>& text) const {
  return Columns<Series>{{"", "solver", &Series::label}, {"", "sides", [](auto& s) { return or_dash(s.sides); }}}
      .across(resolutions(), &Resolution::label, [&](const Series& s, const Resolution& r) { return cell(s, r, text); })
      .table({title, note, {}}, series());
}

std::vector<Family> families(const std::vector<RunRecord>& runs) {
  std::vector<Family> out;
  std::map<std::string, std::size_t> index;
  std::map<std::string, int> names;
  for (const RunRecord& c : runs) {
    const Parsed p = parse(c);
    const auto [at, is_new] = index.emplace(p.family, out.size());
    if (is_new) {
      Family f;
      const int same_name = ++names[p.name];
      f.name = same_name > 1 ? fmt::format("{} ({})", p.name, same_name) : p.name;
      f.paper_table = p.paper_table;
      out.push_back(std::move(f));
    }
    Family& f = out[at->second];
    PlacedRun placed{&c, p.resolution, {c.header.solver, c.header.setting, p.sides}};
    while (f.find(placed.series, placed.resolution) != nullptr) ++placed.series.repeat;
    f.runs.push_back(std::move(placed));
  }
  return out;
}

std::string frames_mark(const RunRecord& run, const std::vector<const RunRecord*>& all) {
  const auto frames = [](const RunRecord& c) { return c.trials.empty() ? 0 : c.trials.front().frames(); };
  int most = 0;
  for (const RunRecord* c : all)
    if (c->header.scene == run.header.scene) most = std::max(most, frames(*c));
  return frames(run) > 0 && frames(run) < most ? fmt::format(" (first {} frames)", frames(run)) : "";
}

Table without_empty_columns(Table t) {
  for (std::size_t k = t.rows.front().size(); k-- > 1;) {
    const auto value = [&](const auto& row) { return &row != &t.rows.front() && k < row.size() && row[k] != "–"; };
    if (std::any_of(t.rows.begin(), t.rows.end(), value)) continue;
    for (auto& row : t.rows)
      if (k < row.size()) row.erase(row.begin() + static_cast<std::ptrdiff_t>(k));
  }
  return t;
}

}  // namespace clothbench
