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

std::filesystem::path folder(const RunRecord& c) { return std::filesystem::path(c.file).parent_path(); }

double longer_side(const json& scenario) {
  const json size = scenario.value(json::json_pointer("/cloth/size_m"), json());
  if (!size.is_array() || size.size() != 2) return kMissing;
  return std::max(size[0].get<double>(), size[1].get<double>());
}

/// Setting of the partner run: "default" for "all-on", <setting> for "<setting>,all-on".
std::string plain_setting(const std::string& setting) {
  if (setting == kAllOn) return "default";
  const std::string tail = std::string(",") + kAllOn;
  return setting.ends_with(tail) ? setting.substr(0, setting.size() - tail.size()) : setting;
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
  for (const RunRecord* c : {f.needed, f.all})
    if (c->outcome.status != "ok") return c->outcome.status;
  if (std::isnan(f.moved)) return "not measured";
  return f.moved == 0 ? "0 (bitwise)" : fmt::format("{:.1e}", f.moved);
}

/// One of the two runs, for JSON.
json json_of(const RunRecord& c) {
  json out = {{"status", c.outcome.status}, {"message", c.outcome.message}, {"stages", c.header.stages.size()}};
  for (const Quantity& q : kQuantities) out[q.name] = finite_or_null(summary_value(c, q.name));
  return out;
}

Columns<FeatureCost> cost_columns() {
  Columns<FeatureCost> out = {{"scene", "scene", [](auto& f) { return f.needed->header.scene; }},
                              {"solver", In::Both, [](auto& f) { return f.needed->header.solver; }},
                              {"setting", In::Both, [](auto& f) { return f.needed->header.setting; }},
                              {"", "solver", [](auto& f) { return label_of(*f.needed); }},
                              {"status_needed", In::Csv, [](auto& f) { return f.needed->outcome.status; }},
                              {"status_all", In::Csv, [](auto& f) { return f.all->outcome.status; }},
                              {"moved", In::Csv, &FeatureCost::moved},
                              {"moved_over_longer_side", In::Json, &FeatureCost::moved},
                              {"no_op", In::Json, &FeatureCost::no_op},
                              {"wall_ratio", In::Json, [](auto& f) { return ratio(f, "frame_wall_median_s"); }},
                              {"device_ratio", In::Json, [](auto& f) { return ratio(f, "frame_device_median_s"); }},
                              {"needed", In::Json, [](auto& f) { return json_of(*f.needed); }},
                              {"all", In::Json, [](auto& f) { return json_of(*f.all); }},
                              {"stages_needed", In::Csv, [](auto& f) { return f.needed->header.stages.size(); }},
                              {"stages_all", In::Csv, [](auto& f) { return f.all->header.stages.size(); }},
                              {"added", In::Both, &FeatureCost::added}};
  for (const Quantity& q : kQuantities) {
    out.add({{std::string(q.name) + "_needed", In::Csv, [&](auto& f) { return summary_value(*f.needed, q.name); }},
             {std::string(q.name) + "_all", In::Csv, [&](auto& f) { return summary_value(*f.all, q.name); }},
             {"", q.head, [&](auto& f) { return both(f, q); }}});
    if (q.scale == 1e3) out.push_back({"", "×", [&](auto& f) { return ratio(f, q.name); }, digits(3)});
  }
  return out.add(
      {{"", "stages",
        [](auto& f) { return fmt::format("{} → {}", f.needed->header.stages.size(), f.all->header.stages.size()); }},
       {"", "moved", moved_text},
       {"", "added", &FeatureCost::added}});
}

bool measured(const FeatureCost& f) { return f.needed->outcome.status == "ok" && f.all->outcome.status == "ok"; }

}  // namespace

bool is_all_on(const RunRecord& c) {
  const json scenario = scenario_of(c);
  return scenario.is_object() && scenario.contains("irrelevant");
}

std::vector<FeatureCost> feature_costs(const std::vector<RunRecord>& runs) {
  std::vector<FeatureCost> out;
  for (const RunRecord& c : runs) {
    const json scenario = scenario_of(c);
    if (!scenario.is_object() || !scenario.contains("irrelevant")) continue;
    for (const RunRecord& n : runs) {
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
  const std::string note =
      "Each scene as it is → with every other feature of its solver switched on where it cannot matter: colliders "
      "100 m off with "
      "friction, bending and damping of 1e-30 (what was added: last column). Timed in turns, median. Moved: "
      "greatest distance of a "
      "vertex in one run from the other, over the longer side.";
  return cost_columns().table(
      {"Cost of features that a scene does not use",
       with_withheld(note + fmt::format(" Bytes: {}", kWhatBytesAre),
                     runs_of(costs, &FeatureCost::needed, &FeatureCost::all), {"frame_wall_median_s"}),
       {}},
      costs);
}

Table no_op_table(const std::vector<FeatureCost>& costs) {
  Table t{"Does what is irrelevant change anything?",
          "Scenes in which no vertex moved by more than 1e-6 of the longer side. A property of each solver: where an "
          "irrelevant feature moves the cloth, its measured errors depend on what else is in the scene.",
          {{"solver", "scenes passed", "bitwise", "worst", "in"}}};
  std::vector<std::string> solvers = distinct(costs, [](const FeatureCost& f) { return f.needed->header.solver; });
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

json feature_cost_json(const std::vector<FeatureCost>& costs) { return cost_columns().json(costs); }
std::string feature_cost_csv(const std::vector<FeatureCost>& costs) { return cost_columns().csv(costs); }

}  // namespace clothbench
