#include "report/penetration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <tuple>

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

bool is_pulled_strip(const json& scenario) {
  return scenario.is_object() && scenario.value(json::json_pointer("/truth/card"), json()) == "two-hand-pull";
}

/// By what touches the cloth; the rarest first.
std::string kind_of(const json& scenario) {
  if (is_pulled_strip(scenario)) return "wave";
  if (filled(scenario, "grips")) return "grip";
  std::set<std::string> types;
  for (const json& c : scenario["colliders"])
    if (c.is_object()) types.insert(c.value("type", ""));
  if (types.contains("hand_mesh")) return "hand";
  if (types.contains("hand_capsules")) return "capsules";
  return types.contains("room") || types.contains("mesh") ? "rooms" : "shapes";
}

constexpr std::pair<const char*, const char*> kKinds[] = {{"rooms", "Cloth on meshes that stand still"},
                                                          {"capsules", "A hand of capsules sweeps"},
                                                          {"hand", "A hand mesh pushes"},
                                                          {"grip", "Hands hold and pull"},
                                                          {"wave", "Bars pull a strip that has an exact answer"},
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

std::string ending(const CellRecord& c) {
  if (c.outcome.failed_frame < 0) return c.outcome.status;
  return fmt::format("{} at {}", c.outcome.status, c.outcome.failed_frame);
}

double value(const ContactRow& r, const char* name) { return summary_value(*r.cell, name); }

/// A length in mm: three digits, and what is not nothing never reads as 0.
std::string mm(double v) {
  if (!std::isfinite(v)) return "–";
  const double x = 1e3 * v;
  return v == 0 ? "0" : x < 0.01 ? "<0.01" : significant(x, x < 1 ? 2 : 3);
}

std::string share_text(double v) {
  if (!std::isfinite(v)) return "–";
  const double x = 100 * v;
  return v == 0 ? "0" : std::abs(x) < 0.1 ? "<0.1" : significant(x, x < 10 ? 2 : 3);
}

std::string count(double v) { return std::isfinite(v) ? fmt::format("{:.0f}", v) : "–"; }

std::string number(double v) { return std::isinf(v) ? "never" : significant(v, 2); }

struct Column {
  std::string head;
  std::vector<const char*> names;  ///< summary values it shows
  std::string (*text)(double) = nullptr;
};

const std::vector<Column> kContactColumns = {
    {"tunnelled, most / end [%]", {"tunnelled_fraction_max", "tunnelled_fraction_end"}, share_text},
    {"tunnelled depth [mm]", {"tunnelled_depth_max_m"}, mm},
    {"contour, most / settled [mm]", {"contact_length_max_m", "contact_length_settled_m"}, mm},
    {"depth, vertex / any [mm]", {"depth_vertex_max_m", "depth_max_m"}, mm},
    {"wrong side [samples]", {"wrong_side_samples_max"}, count},
    {"through itself, most / settled [mm]", {"self_contact_length_max_m", "self_contact_length_settled_m"}, mm},
    {"crossed, longest [s]", {"contact_violated_longest_s"}, number},
    {"popping [mm]", {"pop_displacement_m"}, mm},
    {"popping speed [of limit]", {"pop_speed_ratio"}, number},
    {"strain, most / end [%]", {"stretch_max", "stretch_max_end"}, share_text},
    {"greatest strain's error, most / RMS [of v0/c]", {"truth_quantity_error_max", "truth_quantity_error"}, number},
};

std::vector<const CellRecord*> cells_of(const ContactSetUp& s) {
  std::vector<const CellRecord*> out;
  for (const ContactScene& scene : s.scenes)
    for (const ContactRow& r : scene.rows) out.push_back(r.cell);
  return out;
}

Table by_scene(const ContactSetUp& s, const std::string& title, const std::string& note,
               const std::vector<Column>& columns,
               const std::function<void(const ContactRow&, std::vector<std::string>&)>& more) {
  Table t{title, note, {{"scene", "solver", "sides"}}};
  std::vector<Column> shown;
  for (const Column& c : columns) {
    const auto known = [&](const ContactRow& r) {
      return std::any_of(c.names.begin(), c.names.end(), [&](const char* n) { return std::isfinite(value(r, n)); });
    };
    if (std::any_of(s.scenes.begin(), s.scenes.end(), [&](const ContactScene& scene) {
          return std::any_of(scene.rows.begin(), scene.rows.end(), known);
        }))
      shown.push_back(c);
  }
  for (const Column& c : shown) t.rows[0].push_back(c.head);
  for (const ContactScene& scene : s.scenes)
    for (const ContactRow& r : scene.rows) {
      std::vector<std::string> row = {scene.name, r.series.label(), r.series.sides.empty() ? "–" : r.series.sides};
      for (const Column& c : shown) {
        std::string text;
        bool any = false;
        for (const char* name : c.names) {
          any = any || std::isfinite(value(r, name));
          text += (text.empty() ? "" : " / ") + c.text(value(r, name));
        }
        row.push_back(any ? text : "–");
      }
      more(r, row);
      t.rows.push_back(std::move(row));
    }
  return t;
}

/// True if the solver declares to ignore all contact and grips: then a kept expectation is luck.
bool touches_nothing(const CellRecord& c) {
  const json features =
      c.header.environment.is_object() ? c.header.environment.value("solver_features", json()) : json();
  if (!features.is_object() || !filled(features, "ignores")) return false;
  const json& ignored = features["ignores"];
  bool all = std::find(ignored.begin(), ignored.end(), name_of(Feature::MovingPins)) != ignored.end();
  kColliderFeatures.for_each(
      [&](Feature f) { all = all && std::find(ignored.begin(), ignored.end(), name_of(f)) != ignored.end(); });
  return all;
}

/// The bound a scene puts on a summary value, as text: "at most 0".
std::string bound(const json& scenario, const std::string& name) {
  const json e = scenario.is_object() ? scenario.value("expect", json::object()).value(name, json()) : json();
  if (e.is_string()) return e.get<std::string>();
  std::string text;
  for (const auto& [key, words] : {std::pair{"at_least", "at least "}, std::pair{"at_most", "at most "}})
    if (e.is_object() && e.contains(key)) text += (text.empty() ? "" : ", ") + std::string(words) + e[key].dump();
  return text.empty() ? "–" : text;
}

}  // namespace

bool has_contact(const CellRecord& c) {
  const json s = scenario_of(c);
  return filled(s, "colliders") || filled(s, "grips");
}

bool pulls_strip(const CellRecord& c) { return is_pulled_strip(scenario_of(c)); }

std::vector<ContactSetUp> set_ups(const std::vector<CellRecord>& cells) {
  std::vector<ContactSetUp> all;
  for (const auto& [kind, title] : kKinds) all.push_back({kind, title, {}});
  for (const CellRecord& c : cells) {
    if (!has_contact(c)) continue;
    const json scenario = scenario_of(c);
    ContactSetUp& up = *std::find_if(all.begin(), all.end(),
                                     [kind = kind_of(scenario)](const ContactSetUp& u) { return u.kind == kind; });
    if (up.title.back() != ')') up.title += paper_place(scenario);
    auto scene =
        std::find_if(up.scenes.begin(), up.scenes.end(), [&](const auto& s) { return s.name == c.header.scene; });
    if (scene == up.scenes.end()) scene = up.scenes.insert(up.scenes.end(), {c.header.scene, {}});
    ContactRow row{&c, {c.header.solver, c.header.setting, sides_of(scenario)}};
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

std::vector<BoundResult> bound_results(const CellRecord& c) {
  std::vector<BoundResult> out;
  for (const auto& [name, v] : c.summary)
    if (name.starts_with(kExpect)) out.push_back({name.substr(kExpect.size()), v});
  return out;
}

std::string verdict(const CellRecord& c) {
  if (c.outcome.status != "ok") return ending(c);
  bool withheld = false, measured = true;
  const std::vector<BoundResult> bounds = bound_results(c);
  for (const BoundResult& b : bounds) {
    if (b.kept == 0) return "broken";
    withheld = withheld || c.withheld.contains(kExpect + b.name);
    measured = measured && b.kept == 1;
  }
  if (bounds.empty() || withheld) return "–";
  if (!measured) return "not measured";
  return touches_nothing(c) ? "ignored" : "kept";
}

Table verdict_table(const std::vector<ContactSetUp>& ups) {
  std::vector<std::string> solvers;
  for (const ContactSetUp& u : ups)
    for (const ContactScene& s : u.scenes)
      for (const ContactRow& r : s.rows)
        if (std::find(solvers.begin(), solvers.end(), r.series.label()) == solvers.end())
          solvers.push_back(r.series.label());
  std::sort(solvers.begin(), solvers.end());
  Table t{
      "Penetration: does each solver keep what the scene expects?",
      "Kept: every bound of the scene's `expect`, measured over the whole scene. Ignored: kept by a solver that "
      "touches nothing. – : not run, or nothing to expect. In "
      "the tables below, tunnelled: share of the cloth that has passed to the other side of a mesh. Contour: length "
      "of the "
      "curves in which cloth and colliders cross; settled: the most in the last 0.5 s. Depth: how far the cloth is "
      "inside "
      "a collider, margin not counted. Wrong side: vertices and cell centres that a moving hand went through. Crossed: "
      "longest time with a contour. Popping: greatest way of a vertex within 3 frames after the last contact, and "
      "speed over "
      "the greater of twice the hand's and a fall of the cloth's length. Strain: of the structural edges. Time: median "
      "over the timed frames.",
      {{"scene"}}};
  t.rows[0].insert(t.rows[0].end(), solvers.begin(), solvers.end());
  std::set<std::string> bounds;
  for (const ContactSetUp& u : ups)
    for (const ContactScene& s : u.scenes) {
      std::vector<std::string> row = {s.name};
      for (const std::string& solver : solvers) {
        const auto at =
            std::find_if(s.rows.begin(), s.rows.end(), [&](const ContactRow& r) { return r.series.label() == solver; });
        row.push_back(at == s.rows.end() ? "–" : verdict(*at->cell));
      }
      t.rows.push_back(std::move(row));
      for (const ContactRow& r : s.rows)
        for (const BoundResult& b : bound_results(*r.cell)) bounds.insert(kExpect + b.name);
    }
  std::vector<const CellRecord*> cells;
  for (const ContactSetUp& u : ups)
    for (const CellRecord* c : cells_of(u)) cells.push_back(c);
  t.note = with_withheld(t.note, cells, {bounds.begin(), bounds.end()});
  return t;
}

Table contact_table(const ContactSetUp& s) {
  Table t = by_scene(s, s.title, "", kContactColumns, [](const ContactRow& r, std::vector<std::string>& row) {
    row.push_back(paired(1e3 * value(r, "frame_wall_median_s"), 1e3 * value(r, "frame_device_median_s"), " / ", 3));
    row.push_back(verdict(*r.cell));
  });
  t.rows[0].insert(t.rows[0].end(), {"wall / GPU [ms]", "expected"});
  std::vector<std::string> shown = {"frame_wall_median_s"};
  for (const Column& c : kContactColumns) shown.insert(shown.end(), c.names.begin(), c.names.end());
  t.note = with_withheld(t.note, cells_of(s), shown);
  return t;
}

Table cost_table(const ContactSetUp& s) {
  Table t = by_scene(s, "Cost: " + s.title,
                     fmt::format("Bytes a frame: {} Memory: device-local buffers. – on a CPU.", kWhatBytesAre), {},
                     [](const ContactRow& r, std::vector<std::string>& row) {
                       row.push_back(bytes_pair(*r.cell, "read_B_per_frame", "write_B_per_frame", 1e-3));
                       row.push_back(significant(1e-3 * value(r, "device_memory_B"), 4));
                       row.push_back(significant(value(r, "dispatches"), 1));
                       row.push_back(significant(1e3 * value(r, "load_s"), 3));
                     });
  t.rows[0].insert(t.rows[0].end(), {"kB read / written", "memory [kB]", "dispatches", "load [ms]"});
  t.note = with_withheld(t.note, cells_of(s), {"load_s"});
  return t;
}

Table broken_table(const std::vector<ContactSetUp>& ups) {
  Table t{"Broken expectations", "", {{"scene", "solver", "what", "expected", "found"}}};
  for (const ContactSetUp& u : ups)
    for (const ContactScene& s : u.scenes)
      for (const ContactRow& r : s.rows)
        for (const auto& [what, kept] : bound_results(*r.cell)) {
          if (kept != 0) continue;
          const double found = summary_value(*r.cell, what);
          t.rows.push_back({s.name, r.series.label(), what, bound(scenario_of(*r.cell), what),
                            what == "outcome"      ? ending(*r.cell)
                            : std::isfinite(found) ? fmt::format("{:.4g}", found)
                                                   : "–"});
        }
  return t;
}

}  // namespace clothbench
