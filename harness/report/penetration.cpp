#include "report/penetration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "base/words.hpp"
#include "clothbench/feature.hpp"
#include "metrics/registry.hpp"
#include "report/bytes.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

bool filled(const json& j, const char* key) {
  return j.is_object() && j.contains(key) && j[key].is_array() && !j[key].empty();
}

/// Kind of set-up of runs whose study states none, and of older files: from what touches, the rarest types first.
std::string formerly(const json& scenario) {
  if (!scenario.is_object()) return "";
  if (scenario.value(json::json_pointer("/truth/case"), json()) == "two-hand-pull") return "wave";
  if (filled(scenario, "grips")) return "grip";
  std::set<std::string> types;
  for (const json& c : scenario.value("colliders", json::array()))
    if (c.is_object()) types.insert(c.value("type", ""));
  if (types.contains("hand_mesh")) return "hand";
  if (types.contains("hand_capsules")) return "capsules";
  return types.contains("room") || types.contains("mesh") ? "rooms" : "shapes";
}

constexpr std::pair<const char*, const char*> kKinds[] = {{"rooms", "Cloth on static meshes"},
                                                          {"capsules", "A hand of capsules sweeps through cloth"},
                                                          {"hand", "A hand mesh pushes cloth"},
                                                          {"grip", "Hands hold and pull cloth"},
                                                          {"wave", "Bars pull a strip with an exact solution"},
                                                          {"shapes", "Cloth on plain shapes"}};

/// " (section 4.2, Table 5)" of the first scene that says so.
std::string paper_place(const json& scenario) {
  const json paper = scenario.value("paper", json());
  if (!paper.is_object() || !paper.contains("section") || !paper["section"].is_string()) return "";
  std::string text = " (section " + paper["section"].get<std::string>();
  if (paper.contains("table")) text += ", Table " + paper["table"].dump();
  return text + ")";
}

std::string sides_of(const json& scenario) {
  const json sides = scenario.value(json::json_pointer("/cloth/sides"), json());
  return sides.is_string() ? sides.get<std::string>() : "";
}

/// A length in mm with three digits; a value other than 0 is never printed as 0.
std::string mm(double v) {
  if (!std::isfinite(v)) return "–";
  return v == 0 ? "0" : v < 0.01 ? "<0.01" : significant(v, v < 1 ? 2 : 3);
}

std::string share_text(double v) {
  if (!std::isfinite(v)) return "–";
  return v == 0 ? "0" : std::abs(v) < 0.1 ? "<0.1" : significant(v, v < 10 ? 2 : 3);
}

std::string number(double v) { return std::isinf(v) ? "never" : significant(v, 2); }

/// Summary values of one column, separated by " / ".
struct Shown {
  std::string head;
  std::vector<const char*> names;
  NumberFormat format;
  Unit unit = {};
};

constexpr Unit kPercent{"%", 100};

const std::vector<Shown> kShown = {
    {"crossings", {"crossings_max"}, in_form("{:.0f}")},
    {"contour, greatest / settled", {"contact_length_max_m", "contact_length_settled_m"}, mm, kMillimetres},
    {"depth", {"depth_max_m"}, mm, kMillimetres},
    {"self-contact contour, greatest / settled",
     {"self_contact_length_max_m", "self_contact_length_settled_m"},
     mm,
     kMillimetres},
    {"popping", {"pop_max_m"}, mm, kMillimetres},
    {"strain, greatest / end", {"stretch_max", "stretch_max_end"}, share_text, kPercent},
    {"error of greatest strain, greatest / RMS [of v0/c]",
     {"truth_quantity_error_max", "truth_quantity_error"},
     number},
};

std::string shown_text(const RunRecord& c, const Shown& s) {
  std::string text;
  bool any = false;
  for (const char* name : s.names) {
    const double v = summary_value(c, name);
    any = any || std::isfinite(v);
    text += (text.empty() ? "" : " / ") + s.format(s.unit.per_si * v);
  }
  return any ? text : "–";
}

Columns<ContactRow> place_columns() {
  return {{"", "scene", &ContactRow::scene},
          {"", "solver", [](auto& r) { return r.series.label(); }},
          {"", "sides", [](auto& r) { return or_dash(r.series.sides); }}};
}

/// The bound a scene puts on a summary value, as text: "at most 0".
std::string bound(const RunRecord& c, const std::string& name) {
  if (const double exact = summary_value(c, name + kBound); std::isfinite(exact))
    return fmt::format("at most {:.3g}", exact);
  const json scenario = scenario_of(c);
  const json e = scenario.is_object() ? scenario.value("expect", json::object()).value(name, json()) : json();
  if (e.is_string()) return e.get<std::string>();
  std::string text;
  for (const auto& [key, words] : {std::pair{"at_least", "at least "}, std::pair{"at_most", "at most "}})
    if (e.is_object() && e.contains(key)) text += (text.empty() ? "" : ", ") + std::string(words) + e[key].dump();
  return text.empty() ? "–" : text;
}

}  // namespace

bool has_contact(const RunRecord& c) {
  const json s = scenario_of(c);
  return filled(s, "colliders") || filled(s, "grips");
}

std::string set_up_of(const RunRecord& c) {
  const json set_up = environment_of(c, "set_up");
  return set_up.is_null() ? formerly(scenario_of(c)) : set_up.get<std::string>();
}

std::vector<ContactSetUp> set_ups(const std::vector<RunRecord>& runs) {
  std::vector<ContactSetUp> all;
  for (const auto& [kind, title] : kKinds) all.push_back({kind, title, {}});
  for (const RunRecord& c : runs) {
    if (!has_contact(c)) continue;
    const json scenario = scenario_of(c);
    const std::string kind = set_up_of(c);
    ContactSetUp& up = find_or_add(all, [&](const ContactSetUp& u) { return u.kind == kind; }, {kind, kind, {}});
    if (up.title.back() != ')') up.title += paper_place(scenario);
    auto scene =
        std::find_if(up.scenes.begin(), up.scenes.end(), [&](const auto& s) { return s.name == c.header.scene; });
    if (scene == up.scenes.end()) scene = up.scenes.insert(up.scenes.end(), {c.header.scene, {}});
    ContactRow row{&c, {c.header.solver, c.header.setting, sides_of(scenario)}, up.kind, c.header.scene};
    while (std::any_of(scene->rows.begin(), scene->rows.end(),
                       [&](const ContactRow& r) { return r.series == row.series; }))
      ++row.series.repeat;
    scene->rows.push_back(std::move(row));
  }
  std::erase_if(all, [](const ContactSetUp& u) { return u.scenes.empty(); });
  for (ContactSetUp& u : all)
    for (ContactScene& s : u.scenes)
      std::stable_sort(s.rows.begin(), s.rows.end(), [](const ContactRow& a, const ContactRow& b) {
        const auto key = [](const Series& x) { return std::tie(x.solver, x.setting, x.repeat); };
        return key(a.series) < key(b.series);
      });
  return all;
}

std::vector<ContactRow> contact_rows(const std::vector<ContactSetUp>& ups) {
  std::vector<ContactRow> out;
  for (const ContactSetUp& u : ups)
    for (const ContactScene& s : u.scenes) out.insert(out.end(), s.rows.begin(), s.rows.end());
  return out;
}

std::pair<double, double> held_at_m(const RunRecord& c) {
  std::pair<double, double> out = {kMissing, kMissing};
  if (c.outcome.status == "unsupported" || c.outcome.status == "missing") return out;
  std::set<std::string> stated;
  const auto add = [&](const json& margin) {
    if (!margin.is_number()) return;
    const double m = margin.get<double>();
    if (!(out.first <= m)) out.first = m;
    if (!(out.second >= m)) out.second = m;
  };
  if (filled(c.header.plan, "contact_margins"))
    for (const json& m : c.header.plan["contact_margins"]) {
      stated.insert(m.value("collider", ""));
      add(m.value("margin_m", json()));
    }
  // Colliders have the names of their types there, or of what they stand for; a list as long as the scene's is of all.
  const json scenario = scenario_of(c);
  const bool all = filled(c.header.plan, "contact_margins") && filled(scenario, "colliders") &&
                   c.header.plan["contact_margins"].size() >= scenario["colliders"].size();
  if (filled(scenario, "colliders") && !all)
    for (const json& collider : scenario["colliders"])
      if (collider.is_object() && !stated.contains(collider.value("type", ""))) add(collider.value("margin_m", json()));
  return out;
}

std::string held_at(const RunRecord& c) {
  const auto [least, most] = held_at_m(c);
  if (!std::isfinite(most)) return "–";
  return least == most ? fmt::format("{:.3g}", 1e3 * most) : fmt::format("{:.3g} to {:.3g}", 1e3 * least, 1e3 * most);
}

TextRow held_row(const std::vector<ContactRow>& all) {
  std::map<std::string, std::set<std::pair<double, std::string>>> held;
  for (const ContactRow& r : all)
    if (const double most = held_at_m(*r.run).second; std::isfinite(most))
      held[r.series.label()].insert({most, held_at(*r.run)});
  TextRow row{kHeldAt};
  for (const auto& [solver, at] : held)
    for (const auto& [m, words] : at) row.cells[solver] += (row.cells[solver].empty() ? "" : ", ") + words;
  return row;
}

Table verdict_table(const std::vector<ContactSetUp>& ups) {
  const std::vector<ContactRow> all = contact_rows(ups);
  std::vector<std::string> solvers = distinct(all, [](const ContactRow& r) { return r.series.label(); });
  std::sort(solvers.begin(), solvers.end());
  std::vector<TextRow> rows = {held_row(all)};
  if (rows.front().cells.empty()) rows.clear();
  std::set<std::string> bounds;
  for (const ContactSetUp& u : ups)
    for (const ContactScene& s : u.scenes) {
      rows.push_back({s.name});
      for (const ContactRow& r : s.rows) rows.back().cells.emplace(r.series.label(), verdict(*r.run));
    }
  for (const ContactRow& r : all)
    for (const BoundResult& b : bound_results(*r.run)) bounds.insert(kExpect + b.name);
  return text_columns({"scene"}, solvers)
      .table({"Penetration: verdict on each scene's expectations",
              with_withheld(
                  "Pass: every bound of the scene's `expect` holds over the whole scene. Ignored: the scene passes "
                  "although the solver handles no contact. –: not run, or the scene has no bounds. Holds at: distance "
                  "at which the solver holds the cloth off colliders; compare solvers at equal distances. Columns of "
                  "the tables below. Crossings: points that pass through the cloth or a surface between two frames. "
                  "Contour: length of the curves in which cloth and colliders cross; settled: the greatest value in "
                  "the last 0.5 s. Depth: how far the cloth is inside a collider, without the margin. Popping: "
                  "greatest displacement of a vertex within "
                  "1/36 s beyond twice what its neighbours, colliders and grips move in that time. Strain: strain of "
                  "the structural "
                  "edges. Time: median over the timed frames.",
                  runs_of(all, &ContactRow::run), {bounds.begin(), bounds.end()}),
              {}},
             rows);
}

Table contact_table(const ContactSetUp& s) {
  const std::vector<ContactRow> rows = contact_rows({s});
  Columns<ContactRow> columns = place_columns();
  if (std::any_of(rows.begin(), rows.end(), [](auto& r) { return held_at(*r.run) != "–"; }))
    columns.push_back({"", "holds at [mm]", [](auto& r) { return held_at(*r.run); }});
  std::vector<std::string> names = {"frame_wall_median_s"};
  for (const Shown& shown : kShown) {
    names.insert(names.end(), shown.names.begin(), shown.names.end());
    if (std::any_of(rows.begin(), rows.end(), [&](auto& r) { return shown_text(*r.run, shown) != "–"; }))
      columns.push_back({"", shown.head, [&](auto& r) { return shown_text(*r.run, shown); }, {}, shown.unit});
  }
  const std::vector<const RunRecord*> runs = runs_of(rows, &ContactRow::run);
  const auto times_of = [&](auto& r) {
    const std::string times = paired(1e3 * summary_value(*r.run, "frame_wall_median_s"),
                                     1e3 * summary_value(*r.run, "frame_device_median_s"), " / ", 3);
    return times == "–" ? times : times + frames_mark(*r.run, runs);
  };
  // Times that are withheld leave their column, and the note says why.
  if (std::any_of(rows.begin(), rows.end(), [&](auto& r) { return times_of(r) != "–" || !r.run->withheld.empty(); }))
    columns.push_back({"", "wall / GPU [ms]", times_of});
  columns.push_back({"", "verdict", [](auto& r) { return verdict(*r.run); }});
  return columns.table({s.title, with_withheld("", runs, names), {}}, rows);
}

Table cost_table(const ContactSetUp& s) {
  const std::vector<ContactRow> rows = contact_rows({s});
  const std::string note =
      fmt::format("Bytes a frame: {} Memory: device-local buffers. –: a CPU solver.", kWhatBytesAre);
  const Table all =
      place_columns()
          .add({{"", "kB read / written",
                 [](auto& r) { return bytes_pair(*r.run, "read_B_per_frame", "write_B_per_frame", 1e-3); }},
                {"", "memory", summary("device_memory_B"), digits(4), kKilobytes},
                {"", "dispatches", summary("dispatches"), digits(1)},
                {"", "load", summary("load_s"), digits(3), kMilliseconds}})
          .table({"Cost: " + s.title, with_withheld(note, runs_of(rows, &ContactRow::run), {"load_s"}), {}}, rows);
  return without_empty_columns(all);  // without a GPU solver: the time to load alone
}

Table failed_expectations_table(const std::vector<ContactSetUp>& ups) {
  struct Broken : ContactRow {
    std::string name;
  };
  std::vector<Broken> all;
  for (const ContactRow& r : contact_rows(ups))
    for (const auto& [name, kept] : bound_results(*r.run))
      if (kept == 0) all.push_back({r, name});
  return Columns<Broken>{{"", "scene", &Broken::scene},
                         {"", "solver", [](auto& b) { return b.series.label(); }},
                         {"", "bound", &Broken::name},
                         {"", "expected", [](auto& b) { return bound(*b.run, b.name); }},
                         {"", "found",
                          [](auto& b) -> Value {
                            if (b.name == "outcome") return ending(b.run->outcome);
                            return summary_value(*b.run, b.name);
                          },
                          in_form("{:.4g}")}}
      .table({"Bounds that failed", "", {}}, all);
}

}  // namespace clothbench
