#include "report/feature_cost.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/json_number.hpp"
#include "clothbench/solver.hpp"
#include "report/bytes.hpp"
#include "report/grid.hpp"
#include "report/trajectories.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr const char* kAllOn = "all-on";

struct Quantity {
  const char *name, *head;
  double scale;
};

const Quantity kQuantities[] = {{"frame_wall_median_s", "wall [ms]", 1e3},
                                {"frame_device_median_s", "GPU [ms]", 1e3},
                                {"dispatches", "dispatches", 1},
                                {"read_B_per_frame", "read [kB]", 1e-3},
                                {"write_B_per_frame", "written [kB]", 1e-3},
                                {"device_memory_B", "memory [kB]", 1e-3}};

std::filesystem::path folder(const CellRecord& c) { return std::filesystem::path(c.file).parent_path(); }

double longer_side(const json& scenario) {
  const json size = scenario.value(json::json_pointer("/cloth/size_m"), json());
  if (!size.is_array() || size.size() != 2) return kMissing;
  return std::max(size[0].get<double>(), size[1].get<double>());
}

/// Setting of the partner of "all-on" or "<setting>,all-on".
std::string plain_setting(const std::string& setting) {
  if (setting == kAllOn) return "default";
  const std::string tail = std::string(",") + kAllOn;
  return setting.ends_with(tail) ? setting.substr(0, setting.size() - tail.size()) : setting;
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& w : words) out += (out.empty() ? "" : ", ") + w;
  return out;
}

std::string both(const FeatureCost& f, const Quantity& q) {
  const double a = summary_value(*f.needed, q.name), b = summary_value(*f.all, q.name);
  if (std::string(q.name) == "read_B_per_frame" && std::isfinite(a) && std::isfinite(b))
    return bytes_read(*f.needed, q.scale * a, 3) + " → " + bytes_read(*f.all, q.scale * b, 3);
  return paired(q.scale * a, q.scale * b, " → ", 3);
}

double ratio(const FeatureCost& f, const char* name) {
  return summary_value(*f.all, name) / summary_value(*f.needed, name);
}

std::string moved_text(const FeatureCost& f) {
  for (const CellRecord* c : {f.needed, f.all})
    if (c->outcome.status != "ok") return c->outcome.status;
  if (std::isnan(f.moved)) return "not measured";
  return f.moved == 0 ? "0 (bitwise)" : fmt::format("{:.1e}", f.moved);
}

bool measured(const FeatureCost& f) { return f.needed->outcome.status == "ok" && f.all->outcome.status == "ok"; }

}  // namespace

bool is_all_on(const CellRecord& c) {
  const json scenario = json::parse(c.header.scenario_json, nullptr, false);
  return scenario.is_object() && scenario.contains("irrelevant");
}

std::vector<FeatureCost> feature_costs(const std::vector<CellRecord>& cells) {
  std::vector<FeatureCost> out;
  for (const CellRecord& c : cells) {
    const json scenario = json::parse(c.header.scenario_json, nullptr, false);
    if (!scenario.is_object() || !scenario.contains("irrelevant")) continue;
    for (const CellRecord& n : cells) {
      const bool same = n.header.scene == c.header.scene && n.header.solver == c.header.solver &&
                        folder(n) == folder(c) && n.header.setting == plain_setting(c.header.setting) &&
                        flat_settings(n.header.settings) == flat_settings(c.header.settings) && &n != &c;
      if (!same || n.outcome.status == "missing" || c.outcome.status == "missing") continue;
      FeatureCost f{&n, &c, scenario["irrelevant"].get<std::vector<std::string>>()};
      if (measured(f)) f.moved = trajectories_apart(n, c).max_m / longer_side(scenario);
      out.push_back(std::move(f));
      break;
    }
  }
  std::stable_sort(out.begin(), out.end(), [](const FeatureCost& a, const FeatureCost& b) {
    return a.needed->header.scene < b.needed->header.scene;
  });
  return out;
}

Table feature_cost_table(const std::vector<FeatureCost>& costs) {
  Table t{"Cost of features that a scene does not use",
          "Each scene as it is → with every other feature of its solver switched on where it cannot matter: colliders "
          "100 m off with "
          "friction, bending and damping of 1e-30 (what was added: last column). Timed in turns, median. Moved: "
          "greatest distance of a "
          "vertex in one run from the other, over the longer side.",
          {{"scene", "solver"}}};
  for (const Quantity& q : kQuantities) {
    t.rows[0].emplace_back(q.head);
    if (q.scale == 1e3) t.rows[0].emplace_back("×");
  }
  for (const char* head : {"stages", "moved", "added"}) t.rows[0].emplace_back(head);
  std::vector<const CellRecord*> cells;
  for (const FeatureCost& f : costs) {
    cells.insert(cells.end(), {f.needed, f.all});
    std::vector<std::string> row = {f.needed->header.scene,
                                    Series{f.needed->header.solver, f.needed->header.setting, ""}.label()};
    for (const Quantity& q : kQuantities) {
      row.push_back(both(f, q));
      if (q.scale == 1e3) row.push_back(significant(ratio(f, q.name), 3));
    }
    row.push_back(fmt::format("{} → {}", f.needed->header.stages.size(), f.all->header.stages.size()));
    row.push_back(moved_text(f));
    row.push_back(joined(f.added));
    t.rows.push_back(std::move(row));
  }
  t.note = with_withheld(t.note + fmt::format(" Bytes: {}", kWhatBytesAre), cells, {"frame_wall_median_s"});
  return t;
}

Table no_op_table(const std::vector<FeatureCost>& costs) {
  Table t{"Does what is irrelevant change anything?",
          "Scenes in which no vertex moved by more than 1e-6 of the longer side. A property of each solver: where an "
          "irrelevant feature moves the cloth, its measured errors depend on what else is in the scene.",
          {{"solver", "scenes kept", "bitwise", "worst", "in"}}};
  std::vector<std::string> solvers;
  for (const FeatureCost& f : costs)
    if (std::find(solvers.begin(), solvers.end(), f.needed->header.solver) == solvers.end())
      solvers.push_back(f.needed->header.solver);
  std::sort(solvers.begin(), solvers.end());
  for (const std::string& solver : solvers) {
    int kept = 0, bitwise = 0, all = 0;
    const FeatureCost* worst = nullptr;
    for (const FeatureCost& f : costs) {
      if (f.needed->header.solver != solver || !measured(f)) continue;
      ++all;
      kept += f.no_op();
      bitwise += f.moved == 0;
      if (worst == nullptr || !(f.moved <= worst->moved)) worst = &f;
    }
    t.rows.push_back({solver, fmt::format("{} of {}", kept, all), fmt::format("{} of {}", bitwise, all),
                      worst == nullptr ? "–" : moved_text(*worst),
                      worst == nullptr ? "–" : worst->needed->header.scene});
  }
  return t;
}

json feature_cost_json(const std::vector<FeatureCost>& costs) {
  json out = json::array();
  for (const FeatureCost& f : costs) {
    json row = {{"scene", f.needed->header.scene},
                {"solver", f.needed->header.solver},
                {"setting", f.needed->header.setting},
                {"added", f.added},
                {"moved_over_longer_side", finite_or_null(f.moved)},
                {"no_op", f.no_op()},
                {"wall_ratio", finite_or_null(ratio(f, "frame_wall_median_s"))},
                {"device_ratio", finite_or_null(ratio(f, "frame_device_median_s"))}};
    for (const auto& [name, cell] : {std::pair{"needed", f.needed}, std::pair{"all", f.all}}) {
      json& part = row[name] = {
          {"status", cell->outcome.status}, {"message", cell->outcome.message}, {"stages", cell->header.stages.size()}};
      for (const Quantity& q : kQuantities) part[q.name] = finite_or_null(summary_value(*cell, q.name));
    }
    out.push_back(std::move(row));
  }
  return out;
}

std::string feature_cost_csv(const std::vector<FeatureCost>& costs) {
  std::vector<std::string> head = {"scene", "solver",        "setting",    "status_needed", "status_all",
                                   "moved", "stages_needed", "stages_all", "added"};
  for (const Quantity& q : kQuantities)
    for (const char* of : {"_needed", "_all"}) head.push_back(std::string(q.name) + of);
  std::string out = csv_row(head);
  for (const FeatureCost& f : costs) {
    std::vector<std::string> row = {f.needed->header.scene,
                                    f.needed->header.solver,
                                    f.needed->header.setting,
                                    f.needed->outcome.status,
                                    f.all->outcome.status,
                                    csv_number(f.moved),
                                    std::to_string(f.needed->header.stages.size()),
                                    std::to_string(f.all->header.stages.size()),
                                    joined(f.added)};
    for (const Quantity& q : kQuantities)
      for (const CellRecord* c : {f.needed, f.all}) row.push_back(csv_number(summary_value(*c, q.name)));
    out += csv_row(row);
  }
  return out;
}

}  // namespace clothbench
