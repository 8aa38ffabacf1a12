#include "report/feature_cost.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json_number.hpp"
#include "report/bytes.hpp"
#include "report/grid.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

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

std::string both(const RunPair& f, const Quantity& q) {
  const double a = summary_value(*f.run, q.name), b = summary_value(*f.other, q.name);
  if (std::string(q.name) == "read_B_per_frame" && std::isfinite(a) && std::isfinite(b))
    return bytes_read(*f.run, q.scale * a, 3) + " → " + bytes_read(*f.other, q.scale * b, 3);
  return paired(q.scale * a, q.scale * b, " → ", 3);
}

double ratio(const RunPair& f, const char* name) { return summary_value(*f.other, name) / summary_value(*f.run, name); }

std::string moved_text(const RunPair& f) {
  for (const RunRecord* c : {f.run, f.other})
    if (c->outcome.status != "ok") return c->outcome.status;
  if (std::isnan(f.value)) return "not measured";
  return f.value == 0 ? "0 (bitwise)" : fmt::format("{:.1e}", f.value);
}

std::vector<std::string> added(const RunPair& f) {
  return scenario_of(*f.other).value("irrelevant", std::vector<std::string>{});
}

/// One of the two runs, for JSON.
json json_of(const RunRecord& c) {
  json out = {{"status", c.outcome.status}, {"message", c.outcome.message}, {"stages", c.header.stages.size()}};
  for (const Quantity& q : kQuantities) out[q.name] = finite_or_null(summary_value(c, q.name));
  return out;
}

Columns<RunPair> cost_columns() {
  Columns<RunPair> out = {{"scene", "scene", [](auto& f) { return f.scene; }},
                          {"solver", In::Both, [](auto& f) { return f.series.solver; }},
                          {"setting", In::Both, [](auto& f) { return f.run->header.setting; }},
                          {"", "solver", [](auto& f) { return label_of(*f.run); }},
                          {"status_needed", In::Csv, [](auto& f) { return f.run->outcome.status; }},
                          {"status_all", In::Csv, [](auto& f) { return f.other->outcome.status; }},
                          {"moved", In::Csv, &RunPair::value},
                          {"moved_over_longer_side", In::Json, &RunPair::value},
                          {"no_op", In::Json, &RunPair::within},
                          {"wall_ratio", In::Json, [](auto& f) { return ratio(f, "frame_wall_median_s"); }},
                          {"device_ratio", In::Json, [](auto& f) { return ratio(f, "frame_device_median_s"); }},
                          {"needed", In::Json, [](auto& f) { return json_of(*f.run); }},
                          {"all", In::Json, [](auto& f) { return json_of(*f.other); }},
                          {"stages_needed", In::Csv, [](auto& f) { return f.run->header.stages.size(); }},
                          {"stages_all", In::Csv, [](auto& f) { return f.other->header.stages.size(); }},
                          {"added", In::Both, added}};
  for (const Quantity& q : kQuantities) {
    out.add({{std::string(q.name) + "_needed", In::Csv, [&](auto& f) { return summary_value(*f.run, q.name); }},
             {std::string(q.name) + "_all", In::Csv, [&](auto& f) { return summary_value(*f.other, q.name); }},
             {"", q.head, [&](auto& f) { return both(f, q); }}});
    if (q.scale == 1e3) out.push_back({"", "×", [&](auto& f) { return ratio(f, q.name); }, digits(3)});
  }
  return out.add(
      {{"", "stages",
        [](auto& f) { return fmt::format("{} → {}", f.run->header.stages.size(), f.other->header.stages.size()); }},
       {"", "moved", moved_text},
       {"", "added", added}});
}

}  // namespace

bool is_all_on(const RunRecord& c) { return has_block(c, "irrelevant"); }

std::vector<RunPair> feature_costs(const std::vector<RunRecord>& runs) {
  std::vector<RunPair> out = run_pairs(runs, "irrelevant");
  for (RunPair& p : out)
    if (!p.both_ok()) p.value = kMissing;
  std::stable_sort(out.begin(), out.end(), [](const RunPair& a, const RunPair& b) { return a.scene < b.scene; });
  return out;
}

Table feature_cost_table(const std::vector<RunPair>& costs) {
  const std::string note =
      "Before the arrow: the scene alone. After it: the same scene with every other feature of the solver "
      "switched on where the feature cannot change the motion: colliders 100 m away with friction, and "
      "bending and damping of 1e-30. The last column names what was added. Both are timed in turns; times "
      "are medians. Moved: greatest distance of a vertex between the two runs, divided by the longer side.";
  return cost_columns().table({"Cost of features that a scene does not use",
                               with_withheld(note + fmt::format(" Bytes: {}", kWhatBytesAre),
                                             runs_of(costs, &RunPair::run, &RunPair::other), {"frame_wall_median_s"}),
                               {}},
                              costs);
}

Table no_op_table(const std::vector<RunPair>& costs) {
  struct Effect {
    std::string solver;
    int kept = 0, bitwise = 0, all = 0;
    const RunPair* worst = nullptr;
  };
  std::vector<Effect> effects;
  for (const RunPair& f : costs) {
    Effect& e = find_or_add(effects, [&](const Effect& at) { return at.solver == f.series.solver; }, {f.series.solver});
    if (!f.both_ok()) continue;
    ++e.all;
    e.kept += f.within();
    e.bitwise += f.value == 0;
    if (e.worst == nullptr || !(f.value <= e.worst->value)) e.worst = &f;
  }
  std::sort(effects.begin(), effects.end(), [](const Effect& a, const Effect& b) { return a.solver < b.solver; });
  return Columns<Effect>{{"", "solver", &Effect::solver},
                         {"", "scenes passed", [](auto& e) { return fmt::format("{} of {}", e.kept, e.all); }},
                         {"", "bitwise", [](auto& e) { return fmt::format("{} of {}", e.bitwise, e.all); }},
                         {"", "worst", [](auto& e) { return e.worst == nullptr ? "–" : moved_text(*e.worst); }},
                         {"", "in", [](auto& e) { return e.worst == nullptr ? "–" : e.worst->scene; }}}
      .table({"Effect of irrelevant features on the motion",
              "Passed: scenes in which no vertex moved by more than 1e-6 of the longer side. If an irrelevant "
              "feature moves the cloth of a solver, the errors measured for that solver depend on what else is in "
              "the scene.",
              {}},
             effects);
}

json feature_cost_json(const std::vector<RunPair>& costs) { return cost_columns().json(costs); }
std::string feature_cost_csv(const std::vector<RunPair>& costs) { return cost_columns().csv(costs); }

}  // namespace clothbench
