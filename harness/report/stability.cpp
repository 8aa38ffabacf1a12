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

constexpr const char* kExtremes[] = {"stability_speed_max",         "stability_energy_gain_max",
                                     "stability_strain_excess_max", "stability_strain_p99_max",
                                     "stability_bad_geometry_max",  "stability_depth_max",
                                     "stability_unrest_max",        "stability_fall_error_max"};
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
  return c.outcome.klass == "ok" || c.outcome.klass.empty() ? "F8" : c.outcome.klass;
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

std::string with_unit(const std::string& value, const json& axis) {
  const auto unit = axis.value("unit", "");
  return unit.empty() ? value : value + " " + unit;
}

}  // namespace

bool is_stability(const RunRecord& c) {
  const json scenario = scenario_of(c);
  return scenario.is_object() && scenario.contains("stability");
}

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
  Table t{"Robustness",
          "Number of runs of each case by grade. Stable: no failure class. Degraded: only strain or unrest is "
          "out of bounds (F3, F6). Failed: any other class. Classes: F0 not finite, F1 speed, F2 energy gain, "
          "F3 strain, F4 geometry, F5 contact, F6 unrest, F7 stagnation, F8 budget, crash or device.",
          {{"case"}}};
  const auto case_name = [](const RunRecord& c) { return case_of(scenario_of(c)); };
  const std::vector<std::string> solvers = distinct(runs, label_of);
  std::map<std::pair<std::string, std::string>, Tally> tally;
  std::map<std::string, Tally> whole;
  for (const RunRecord& c : runs) {
    tally[{case_name(c), label_of(c)}].add(c);
    whole[label_of(c)].add(c);
  }
  t.rows.back().insert(t.rows.back().end(), solvers.begin(), solvers.end());
  const auto row = [&](const std::string& title, const auto& of) {
    std::vector<std::string> r = {title};
    for (const std::string& s : solvers) r.push_back(of(s));
    t.rows.push_back(std::move(r));
  };
  for (const std::string& kase : distinct(runs, case_name))
    row(kase, [&](const std::string& s) {
      const auto at = tally.find({kase, s});
      return at == tally.end() ? std::string("–") : at->second.text();
    });
  row("all", [&](const std::string& s) { return whole[s].text(); });
  return t;
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
  Table t{"Largest stable values",
          "Smallest over all rows and seeds of a map. ≥: every row is stable over the whole range. none: a row "
          "has no stable value in the range.",
          {{"map", "solver", "largest"}}};
  for (const json& m : maps)
    t.note += " " + m.at("title").get<std::string>() + ": " + m.at("headline").get<std::string>() + ".";
  for (const json& m : maps)
    for (const json& s : m.at("solvers")) {
      std::string value = "unsupported";
      if (!s.at("unsupported").get<bool>()) {
        const double largest = s.at("largest").is_null() ? 0 : s.at("largest").get<double>();
        value = largest == 0 ? "none"
                             : with_unit((s.at("open").get<bool>() ? "≥ " : "") + short_number(largest), m.at("x"));
      }
      t.rows.push_back({m.at("title"), name_of(s), value});
    }
  return t;
}

Table boundary_table(const json& maps) {
  Table t{"Boundaries",
          "Last stable value of x in every row, the smallest over its seeds, to 0.05 decades. ≥: the whole "
          "range is stable.",
          {{"map", "solver", "y", "last stable x", "first unstable x", "seeds"}}};
  for (const json& m : maps)
    for (const json& s : m.at("solvers"))
      for (const json& row : s.at("rows")) {
        double good = INFINITY, bad = INFINITY;
        for (const json& seed : row.at("seeds")) {
          good = std::min(good, seed.at("last_good").get<double>());
          if (!seed.at("first_bad").is_null()) bad = std::min(bad, seed.at("first_bad").get<double>());
        }
        t.rows.push_back({m.at("name"), name_of(s), with_unit(short_number(row.at("y")), m.at("y")),
                          good == 0 ? "none" : (std::isfinite(bad) ? "" : "≥ ") + short_number(good),
                          std::isfinite(bad) ? short_number(bad) : "–", std::to_string(row.at("seeds").size())});
      }
  return t;
}

Table first_failure_table(const std::vector<RunRecord>& runs) {
  Table t{"Runs that were not stable",
          "In brackets: the first frame of that class.",
          {{"solver", "grade", "class", "runs"}}};
  std::map<std::tuple<std::string, int, std::string>, std::string> texts;
  for (const RunRecord& c : runs) {
    const int grade = grade_of(c);
    if (grade < 1) continue;
    std::string& text = texts[{label_of(c), -grade, class_of(c)}];
    text += (text.empty() ? "" : ", ") + c.header.scene;
    if (c.outcome.failed_frame >= 0) text += fmt::format(" ({})", c.outcome.failed_frame);
    if (c.outcome.status != "ok" && c.outcome.status != "diverged") text += " " + c.outcome.status;
  }
  for (const auto& [key, text] : texts)
    t.rows.push_back({std::get<0>(key), kGrades[-std::get<1>(key)], std::get<2>(key), text});
  return t;
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
