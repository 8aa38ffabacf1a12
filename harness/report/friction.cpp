#include "report/friction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/json_number.hpp"
#include "report/grid.hpp"
#include "report/verdict.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

using nlohmann::json;
constexpr const char kItsProcess[] = "its process: ";  // prefix of a crash message

using RunPointers = std::vector<const RunRecord*>;

/// Scene name from the scene's file. The header's name differs between the runs of a search.
Scene scene_of(const RunRecord& c) { return scene_from_json(scenario_of(c), c.file.empty() ? c.header.scene : c.file); }

/// Groups in the order of first appearance.
template <class Key>
std::vector<RunPointers> grouped(const std::vector<RunRecord>& runs, Key key) {
  std::vector<RunPointers> out;
  for (const RunRecord& c : runs) {
    if (!is_friction(c)) continue;
    const auto at =
        std::find_if(out.begin(), out.end(), [&](const RunPointers& group) { return key(*group.front()) == key(c); });
    (at == out.end() ? out.emplace_back() : *at).push_back(&c);
  }
  return out;
}

ThresholdRow row_of(const RunPointers& tries) {
  const RunRecord& first = *tries.front();
  ThresholdRow row{base_name(first), first.header.solver, first.header.setting, {}, {}, {}, {}, false};
  // The first run has the greatest friction, at which the scene has a truth; with less friction there may be none.
  row.of = truth::reference_case_of(scene_of(first))->threshold.value();
  row.found = search_threshold(row.of, [&](double friction) -> std::optional<bool> {
    const std::string name = tried_scene(row.scene, friction);
    for (const RunRecord* c : tries)
      if (c->header.scene == name) return stayed(row.of, *c);
    row.unfinished = true;
    return std::nullopt;
  });
  for (const RunRecord* c : tries)
    if (c->outcome.status == "unsupported") row.unsupported = c->outcome.message;
  for (const RunRecord* c : tries)
    if (c->outcome.status == "crashed") row.crash = c->outcome.message.substr(std::string(kItsProcess).size());
  return row;
}

json answer_json(const FrictionForm& form, const json& error, const std::string& text) {
  return {{"scene", form.scene}, {"what", form.head}, {"error", error}, {"at_most", form.at_most}, {"text", text}};
}

json answer_json(const FrictionForm& form, double error) {
  if (!std::isfinite(error)) return answer_json(form, nullptr, "failed");
  return answer_json(form, error,
                     fmt::format("{}{:.2g}{}", form.threshold && error > 0 ? "+" : "", error,
                                 std::abs(error) <= form.at_most ? " ✓" : ""));
}

json answer(const FrictionForm& form, const ThresholdRow& row) {
  const double error = form.scale * row.found.error;
  if (!row.crash.empty()) return answer_json(form, nullptr, "crashed");
  if (row.unfinished) return answer_json(form, nullptr, "–");
  if (row.found.holds_at_least) return answer_json(form, error, "holds at half of it");
  if (row.found.slips_at_most) return answer_json(form, error, "slips at 1.5 of it");
  return answer_json(form, error);
}

/// `runs`: all of one solver and setting.
json answer(const FrictionForm& form, const RunPointers& runs, const std::vector<ThresholdRow>& rows) {
  const RunHeader& h = runs.front()->header;
  if (form.threshold)
    for (const ThresholdRow& row : rows)
      if (row.scene == form.scene && row.solver == h.solver && row.setting == h.setting) return answer(form, row);
  for (const RunRecord* c : runs) {
    if (is_probe(*c) || c->header.scene != form.scene) continue;
    const std::string& status = c->outcome.status;
    if (status == "unsupported" || status == "crashed") return answer_json(form, nullptr, status);
    if (!form.threshold) return answer_json(form, form.scale * end_error(scene_of(*c), *c));
  }
  return answer_json(form, nullptr, "–");
}

Table threshold_table(const std::vector<ThresholdRow>& rows) {
  static const auto known = [](const ThresholdRow& r) {
    return r.crash.empty() && r.unsupported.empty() && !r.unfinished && !r.found.failed;
  };
  static const auto found = [](const ThresholdRow& r) -> std::string {
    if (known(r))
      return fmt::format("{}{:.5f}", r.found.holds_at_least ? "≤ " : r.found.slips_at_most ? "≥ " : "", r.found.found);
    return !r.crash.empty() ? "crashed" : !r.unsupported.empty() ? "unsupported" : r.unfinished ? "–" : "failed";
  };
  static const auto off = [](const ThresholdRow& r) -> std::string {
    if (!known(r)) return "–";
    return fmt::format("{:+.4f}{}", r.found.error, r.of.error_units == "1" ? "" : " " + r.of.error_units);
  };
  return Columns<ThresholdRow>{{"", "scene", &ThresholdRow::scene},
                               {"", "solver", &ThresholdRow::solver},
                               {"", "setting", &ThresholdRow::setting},
                               {"", "found", found},
                               {"", "exact", [](auto& r) { return r.found.exact; }, in_form("{:.5f}")},
                               {"", "off by", off},
                               {"", "runs", [](auto& r) { return r.found.runs; }}}
      .table({"Thresholds of friction",
              "Found: the smallest coefficient of friction at which the cloth holds, by bisection to 0.1 % between "
              "0.5 and 1.5 times the exact coefficient.",
              {}},
             rows);
}

}  // namespace

bool is_friction(const RunRecord& c) { return is_probe(c) || environment_of(c, "protocol") == kFrictionProtocol; }

std::vector<ThresholdRow> threshold_rows(const std::vector<RunRecord>& runs) {
  std::vector<ThresholdRow> out;
  for (const RunPointers& group : grouped(runs, [](const RunRecord& c) {
         return std::tuple(is_probe(c), base_name(c), c.header.solver, c.header.setting);
       }))
    if (is_probe(*group.front())) out.push_back(row_of(group));
  return out;
}

json threshold_json(const ThresholdRow& r) {
  if (!r.crash.empty()) return {{"scene", r.scene}, {"solver", r.solver}, {"crashed", r.crash}};
  if (!r.unsupported.empty()) return {{"scene", r.scene}, {"solver", r.solver}, {"unsupported", r.unsupported}};
  const FoundThreshold& f = r.found;
  return {{"scene", r.scene},
          {"solver", r.solver},
          {"exact", f.exact},
          {"found", finite_or_null(f.found)},
          {"error", finite_or_null(f.error)},
          {"error_name", r.of.error_name},
          {"error_units", r.of.error_units},
          {"bound", f.holds_at_least  ? "<= "
                    : f.slips_at_most ? ">= "
                                      : ""},
          {"failed", f.failed},
          {"runs", f.runs}};
}

std::string threshold_sentence(const ThresholdRow& r) {
  const FoundThreshold& f = r.found;
  const std::string of = r.scene + " " + r.solver + ": ";
  if (!r.crash.empty()) return of + kItsProcess + r.crash;
  if (!r.unsupported.empty()) return of + "unsupported: " + r.unsupported;
  if (f.failed) return of + fmt::format("its run failed ({} runs)", f.runs);
  return of + fmt::format("holds from friction {}{:.5f} on, exact {:.5f}; {} off by {:+.4f} {} ({} runs)",
                          f.holds_at_least  ? "<= "
                          : f.slips_at_most ? ">= "
                                            : "",
                          f.found, f.exact, r.of.error_name, f.error, r.of.error_units, f.runs);
}

json friction_json(const std::vector<RunRecord>& runs) {
  const std::vector<ThresholdRow> rows = threshold_rows(runs);
  json all = json::array();
  for (const RunPointers& group :
       grouped(runs, [](const RunRecord& c) { return std::tuple(c.header.solver, c.header.setting); })) {
    const RunHeader& h = group.front()->header;
    all.push_back({{"solver", h.solver}, {"setting", h.setting}, {"answers", json::array()}});
    for (const FrictionForm& form : friction_forms()) all.back()["answers"].push_back(answer(form, group, rows));
  }
  return all;
}

Table friction_table(const std::vector<RunRecord>& runs) {
  std::size_t k = 0;
  Columns<json> columns = {{"", "solver", [](auto& j) { return j["solver"]; }},
                           {"", "setting", [](auto& j) { return j["setting"]; }}};
  for (const FrictionForm& f : friction_forms())
    columns.push_back({"", f.head, [k = k++](auto& j) { return j["answers"][k]["text"]; }});
  return columns.table(
      {"Friction by closed forms",
       "Sheets on a slope: errors of the critical angle (Coulomb's cone), of the creep of a sheet that "
       "friction holds, of the displacement of a sheet that slips and of one that stops. Capstan: error of "
       "the overhang that friction holds (on a polygon with one side per row of vertices on the cylinder) "
       "and of the displacement over the cylinder with and without friction. ✓: within the bound. "
       "Thresholds are found by bisection to 0.1 % of the coefficient.",
       {}},
      friction_json(runs));
}

std::vector<Table> friction_tables(const std::vector<RunRecord>& runs) {
  std::vector<Table> out;
  if (std::any_of(runs.begin(), runs.end(), [](const RunRecord& c) { return is_friction(c) && !is_probe(c); }))
    out.push_back(friction_table(runs));
  if (const auto rows = threshold_rows(runs); !rows.empty()) out.push_back(threshold_table(rows));
  return out;
}

std::vector<std::string> friction_crashes(const std::vector<RunRecord>& runs) {
  std::set<std::string> out;
  for (const RunRecord& c : runs)
    if (is_friction(c) && c.outcome.status == "crashed")
      out.insert(fmt::format("{} {}: {}: {}", c.header.solver, c.header.setting, base_name(c), c.outcome.message));
  return {out.begin(), out.end()};
}

}  // namespace clothbench
