#include "report/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include "clothbench/error.hpp"
#include "report/grid.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kExtremes[] = {"stability_speed_max", "stability_energy_gain_max", "stability_strain_excess_max"};
constexpr const char* kGrades[] = {"stable", "degraded", "failed"};

/// "S01 s01-stiffness"
std::string case_of(const json& scenario) {
  const auto name = scenario.value("name", "");
  return scenario["stability"].value("case", "") + " " + (name.size() > 4 && name[3] == '-' ? name.substr(4) : name);
}

/// 0 stable, 1 degraded, 2 failed; -1 if the solver does not support it or it has not been run.
int grade_of(const RunRecord& c) {
  if (c.outcome.status == "unsupported" || c.outcome.status == "missing") return -1;
  const auto at = c.summary.find("stability_grade");
  return at != c.summary.end() && std::isfinite(at->second) ? static_cast<int>(at->second) : 2;
}

std::string class_of(const RunRecord& c) {
  return c.outcome.klass == "ok" || c.outcome.klass.empty() ? "F3" : c.outcome.klass;
}

struct Tally {
  int count[3] = {0, 0, 0}, unsupported = 0, missing = 0;
  std::map<std::string, int> classes[3];

  void add(const RunRecord& c) {
    const int grade = grade_of(c);
    if (grade < 0) {
      ++(c.outcome.status == "missing" ? missing : unsupported);
      return;
    }
    ++count[grade];
    if (grade > 0) ++classes[grade][class_of(c)];
  }

  std::string text() const {
    const int all = count[0] + count[1] + count[2];
    if (all == 0) return unsupported > 0 ? "unsupported" : "–";
    std::string out = fmt::format("{}/{} stable", count[0], all);
    for (int grade : {1, 2}) {
      if (count[grade] == 0) continue;
      out += fmt::format(", {} {} (", count[grade], kGrades[grade]);
      bool first = true;
      for (const auto& [klass, n] : classes[grade]) {
        out += (first ? "" : ", ") + klass + (classes[grade].size() > 1 ? fmt::format(" {}", n) : "");
        first = false;
      }
      out += ")";
    }
    return out;
  }
};

/// 3 digits, with an exponent where that is shorter.
std::string short_number(double v) { return fmt::format("{:.3g}", v); }

std::string name_of(const json& solver) {
  const auto setting = solver.value("setting", "default");
  return solver.at("solver").get<std::string>() + (setting == "default" ? "" : " " + setting);
}

/// A solver in a map.
struct MapRow {
  const json *map, *solver;
};

std::vector<MapRow> map_rows(const json& maps) {
  std::vector<MapRow> out;
  for (const json& m : maps)
    for (const json& s : m.at("solvers")) out.push_back({&m, &s});
  return out;
}

std::string with_unit(const std::string& value, const json& axis) {
  const auto unit = axis.value("unit", "");
  return unit.empty() ? value : value + " " + unit;
}

}  // namespace

bool is_stability(const RunRecord& c) { return has_block(c, "stability"); }

json stability_maps(const std::vector<fs::path>& results) {
  json all = json::array();
  for (const fs::path& result : results) {
    const fs::path file = result / "stability.json";
    std::error_code ec;
    if (!fs::is_regular_file(file, ec)) continue;
    std::ifstream in(file);
    const json j = json::parse(in, nullptr, false);
    if (!j.is_object() || j.value("format", "") != "clothbench-stability")
      throw Error(file.string() + ": expected the maps of a stability study (\"format\": \"clothbench-stability\")");
    for (const json& map : j.at("maps")) all.push_back(map);
  }
  return all;
}

Table robustness_table(const std::vector<RunRecord>& runs) {
  const std::string kAll = "all";
  std::vector<std::string> cases = distinct(runs, [](const RunRecord& c) { return case_of(scenario_of(c)); });
  cases.push_back(kAll);
  std::map<std::pair<std::string, std::string>, Tally> tally;
  for (const RunRecord& c : runs)
    for (const std::string& kase : {case_of(scenario_of(c)), kAll}) tally[{kase, label_of(c)}].add(c);
  return Columns<std::string>{{"", "case", [](auto& kase) { return kase; }}}
      .across(distinct(runs, label_of), std::identity{},
              [&](const std::string& kase, const std::string& solver) {
                const auto at = tally.find({kase, solver});
                return at == tally.end() ? "" : at->second.text();
              })
      .table({"Robustness",
              "Number of runs of each case by grade. Stable: no failure class. Degraded: only strain is out of bounds "
              "(F2). Failed: any other class. Classes: F0 not finite or unbounded, F1 energy gained, F2 strain beyond "
              "the load, F3 budget, crash or device.",
              {}},
             cases);
}

json stability_cases(const std::vector<RunRecord>& runs) {
  json out = json::array();
  for (const RunRecord& c : runs) {
    const int grade = grade_of(c);
    if (grade < 0) continue;
    const std::string kase = scenario_of(c)["stability"].value("case", ""), solver = label_of(c);
    auto at =
        std::find_if(out.begin(), out.end(), [&](const json& r) { return r["case"] == kase && r["solver"] == solver; });
    if (at == out.end()) {
      out.push_back({{"case", kase}, {"solver", solver}});
      for (const char* name : kGrades) out.back()[name] = 0;
      at = out.end() - 1;
    }
    (*at)[kGrades[grade]] = (*at)[kGrades[grade]].get<int>() + 1;
  }
  return out;
}

Table headline_table(const json& maps) {
  std::string note =
      "Smallest over all rows and seeds of a map. ≥: every row is stable over the whole range. none: a row "
      "has no stable value in the range.";
  for (const json& m : maps)
    note += " " + m.at("title").get<std::string>() + ": " + m.at("headline").get<std::string>() + ".";
  static const auto largest = [](const MapRow& r) -> std::string {
    const json& s = *r.solver;
    if (s.at("unsupported").get<bool>()) return "unsupported";
    const double v = s.at("largest").is_null() ? 0 : s.at("largest").get<double>();
    return v == 0 ? "none" : with_unit((s.at("open").get<bool>() ? "≥ " : "") + short_number(v), r.map->at("x"));
  };
  return Columns<MapRow>{{"", "map", [](auto& r) { return r.map->at("title"); }},
                         {"", "solver", [](auto& r) { return name_of(*r.solver); }},
                         {"", "largest", largest}}
      .table({"Largest stable values", note, {}}, map_rows(maps));
}

Table boundary_table(const json& maps) {
  struct Boundary : MapRow {
    const json* row = nullptr;
    double good = INFINITY, bad = INFINITY;
  };
  std::vector<Boundary> all;
  for (const MapRow& r : map_rows(maps))
    for (const json& row : r.solver->at("rows")) {
      Boundary& b = all.emplace_back(Boundary{r, &row});
      for (const json& seed : row.at("seeds")) {
        b.good = std::min(b.good, seed.at("last_good").get<double>());
        if (!seed.at("first_bad").is_null()) b.bad = std::min(b.bad, seed.at("first_bad").get<double>());
      }
    }
  static const auto last_stable = [](const Boundary& b) {
    return b.good == 0 ? "none" : (std::isfinite(b.bad) ? "" : "≥ ") + short_number(b.good);
  };
  return Columns<Boundary>{{"", "map", [](auto& b) { return b.map->at("name"); }},
                           {"", "solver", [](auto& b) { return name_of(*b.solver); }},
                           {"", "y", [](auto& b) { return with_unit(short_number(b.row->at("y")), b.map->at("y")); }},
                           {"", "last stable x", last_stable},
                           {"", "first unstable x", &Boundary::bad, in_form("{:.3g}")},
                           {"", "seeds", [](auto& b) { return b.row->at("seeds").size(); }}}
      .table({"Boundaries",
              "Last stable value of x in every row, the smallest over its seeds, to 0.05 decades. ≥: the whole "
              "range is stable.",
              {}},
             all);
}

Table first_failure_table(const std::vector<RunRecord>& runs) {
  std::map<std::tuple<std::string, int, std::string>, std::string> texts;
  for (const RunRecord& c : runs) {
    const int grade = grade_of(c);
    if (grade < 1) continue;
    std::string& text = texts[{label_of(c), -grade, class_of(c)}];
    text += (text.empty() ? "" : ", ") + c.header.scene;
    if (c.outcome.failed_frame >= 0) text += fmt::format(" ({})", c.outcome.failed_frame);
    if (c.outcome.status != "ok" && c.outcome.status != "diverged") text += " " + c.outcome.status;
  }
  return Columns<decltype(texts)::value_type>{{"", "solver", [](auto& t) { return std::get<0>(t.first); }},
                                              {"", "grade", [](auto& t) { return kGrades[-std::get<1>(t.first)]; }},
                                              {"", "class", [](auto& t) { return std::get<2>(t.first); }},
                                              {"", "runs", [](auto& t) { return t.second; }}}
      .table({"Runs that were not stable", "In brackets: the first frame of that class.", {}}, texts);
}

std::string stability_csv(const std::vector<RunRecord>& runs) {
  Columns<RunRecord> columns = {
      {"case", In::Both, [](auto& c) { return scenario_of(c)["stability"].value("case", ""); }},
      {"scene", In::Both, [](auto& c) { return c.header.scene; }},
      {"solver", In::Both, [](auto& c) { return c.header.solver; }},
      {"setting", In::Both, [](auto& c) { return c.header.setting; }},
      {"status", In::Both, status_of},
      {"grade", In::Both, [](auto& c) { return grade_of(c) < 0 ? "" : kGrades[grade_of(c)]; }},
      {"class", In::Both, [](auto& c) { return grade_of(c) > 0 ? class_of(c) : ""; }},
      {"frame", In::Both, failed_frame_of},
      {"message", In::Both, [](auto& c) { return c.outcome.message; }}};
  for (const char* name : kExtremes) columns.push_back({name, In::Both, summary(name)});
  return columns.csv(runs);
}

}  // namespace clothbench
