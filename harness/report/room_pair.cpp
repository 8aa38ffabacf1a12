#include "report/room_pair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json_number.hpp"
#include "clothbench/solver.hpp"
#include "report/bytes.hpp"
#include "report/grid.hpp"
#include "report/trajectories.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

struct RoomParts {
  std::string rest;  ///< the scenario without the cuts
  bool whole = false, room = false;
};

RoomParts parts_of(const RunRecord& c) {
  json s = scenario_of(c);
  RoomParts p;
  if (!s.is_object() || !s.contains("colliders") || !s["colliders"].is_array()) return p;
  for (json& collider : s["colliders"]) {
    if (!collider.is_object() || collider.value("type", "") != "room") continue;
    p.room = true;
    p.whole = collider.value("cut", "") == "none";
    collider.erase("cut");
  }
  p.rest = s.dump();
  return p;
}

void measure(RoomPair& pair) {
  const Apart apart = trajectories_apart(*pair.cut, *pair.whole);
  pair.distance_end_m = apart.end_m;
  pair.distance_max_m = apart.max_m;
}

/// Device time of the stages that serve static meshes; NaN if there is none.
double mesh_stages_s(const RunRecord& c) {
  double sum = kMissing;
  for (const StageRecord& s : c.header.stages)
    if (std::find(s.serves.begin(), s.serves.end(), "static_mesh") != s.serves.end()) {
      const double t = summary_value(c, "stage_device_median_s." + s.name);
      sum = std::isnan(sum) ? t : sum + t;
    }
  return sum;
}

struct PairQuantity {
  const char* head;
  double scale;
  double (*value)(const RunRecord&);
};

const PairQuantity kPairQuantities[] = {
    {"wall [ms]", 1e3, [](const RunRecord& c) { return summary_value(c, "frame_wall_median_s"); }},
    {"GPU [ms]", 1e3, [](const RunRecord& c) { return summary_value(c, "frame_device_median_s"); }},
    {"mesh stages [ms]", 1e3, mesh_stages_s},
    {"read [kB]", 1e-3, [](const RunRecord& c) { return summary_value(c, "read_B_per_frame"); }},
    {"written [kB]", 1e-3, [](const RunRecord& c) { return summary_value(c, "write_B_per_frame"); }},
    {"memory [kB]", 1e-3, [](const RunRecord& c) { return summary_value(c, "device_memory_B"); }},
    {"load [ms]", 1e3, [](const RunRecord& c) { return summary_value(c, "load_s"); }},
};

std::string distance(double m) { return std::isfinite(m) ? fmt::format("{:.3g} m", m) : "not measured"; }

}  // namespace

std::vector<RoomPair> room_pairs(const std::vector<RunRecord>& runs) {
  std::vector<RoomParts> parts;
  for (const RunRecord& c : runs) parts.push_back(parts_of(c));
  std::vector<RoomPair> out;
  for (std::size_t w = 0; w < runs.size(); ++w) {
    if (!parts[w].room || !parts[w].whole || runs[w].outcome.status == "missing") continue;
    for (std::size_t k = 0; k < runs.size(); ++k) {
      const bool same = parts[k].room && !parts[k].whole && parts[k].rest == parts[w].rest &&
                        runs[k].outcome.status != "missing" && runs[k].header.solver == runs[w].header.solver &&
                        flat_settings(runs[k].header.settings) == flat_settings(runs[w].header.settings);
      if (!same) continue;
      out.push_back({&runs[k], &runs[w]});
      measure(out.back());
      break;
    }
  }
  return out;
}

Table room_table(const std::vector<RoomPair>& pairs) {
  Table t{"SubMesh against the whole room (section 3.2.4)", "", {{"scene", "solver", "mesh"}}};
  for (const PairQuantity& q : kPairQuantities) t.rows[0].emplace_back(q.head);
  std::vector<const RunRecord*> runs;
  for (const RoomPair& p : pairs) {
    runs.insert(runs.end(), {p.cut, p.whole});
    const auto row = [&](const char* mesh, const auto& text) {
      std::vector<std::string> r = {p.cut->header.scene, p.cut->header.solver, mesh};
      for (const PairQuantity& q : kPairQuantities) r.push_back(text(q));
      t.rows.push_back(std::move(r));
    };
    const auto of = [](const RunRecord& c) {
      return [&c](const PairQuantity& q) {
        if (c.outcome.status != "ok") return c.outcome.status;
        const bool reads = std::string(q.head) == "read [kB]";
        return reads ? bytes_read(c, q.scale * q.value(c), 3) : significant(q.scale * q.value(c), 3);
      };
    };
    row("SubMesh", of(*p.cut));
    row("whole room", of(*p.whole));
    row("ratio", [&](const PairQuantity& q) { return significant(q.value(*p.whole) / q.value(*p.cut), 3); });
    t.note +=
        fmt::format("{}{}, {}: greatest distance between the positions of the two, at the end {}, over all frames {}.",
                    t.note.empty() ? "" : " ", p.cut->header.scene, p.cut->header.solver, distance(p.distance_end_m),
                    distance(p.distance_max_m));
  }
  t.note = with_withheld(t.note, runs, {"frame_wall_median_s", "load_s"});
  return t;
}

json room_json(const std::vector<RoomPair>& pairs) {
  json out = json::array();
  for (const RoomPair& p : pairs) {
    json row = {{"scene", p.cut->header.scene},
                {"solver", p.cut->header.solver},
                {"distance_end_m", finite_or_null(p.distance_end_m)},
                {"distance_max_m", finite_or_null(p.distance_max_m)}};
    for (const auto& [name, run] : {std::pair{"sub_mesh", p.cut}, std::pair{"whole_room", p.whole}}) {
      json& part = row[name] = {{"setting", run->header.setting},
                                {"status", run->outcome.status},
                                {"mesh_stages_s", finite_or_null(mesh_stages_s(*run))}};
      for (const char* key : {"frame_wall_median_s", "frame_device_median_s", "read_B_per_frame", "write_B_per_frame",
                              "device_memory_B", "load_s"})
        part[key] = finite_or_null(summary_value(*run, key));
    }
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace clothbench
