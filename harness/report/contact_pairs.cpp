#include "report/contact_pairs.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/json_number.hpp"
#include "base/words.hpp"
#include "report/bytes.hpp"
#include "report/leak.hpp"
#include "report/roles.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

bool ran(const RunRecord& c) { return c.outcome.status != "unsupported"; }

/// Verdict, and the leak if there is one.
std::string reported(const std::string& kind, const RunRecord& c) {
  const std::string leak = c.outcome.status == "ok" ? leak_of(kind, c) : "";
  return verdict(c) + (leak.empty() || leak == kNotPrinted ? "" : " (" + leak + ")");
}

std::string turned_result(const RunPair& p) {
  for (const RunRecord* c : {p.run, p.other})
    if (leak_of(p.kind, *c) == kNotPrinted) return kNotPrinted;
  return same_from_both_sides(p) ? "same" : "differs";
}

/// Distance at the end over the longer side, in the RMS over the cloth.
double apart_at_end(const RunPair& p) {
  return p.apart.rms.empty() ? kMissing : p.apart.rms.back() / longer_side(*p.run);
}

/// Keys of a pair's row; `setting`: whether it is stored.
Columns<RunPair> keys(bool setting) {
  Columns<RunPair> out = {{"scene", "scene", &RunPair::scene},
                          {"solver", In::Both, [](auto& p) { return p.series.solver; }},
                          {"sides", In::Both, [](auto& p) { return p.series.sides; }},
                          {"", "solver", [](auto& p) { return p.series.label(); }}};
  if (setting) out.push_back({"setting", In::Both, [](auto& p) { return p.series.setting; }});
  return out;
}

const Columns<RunPair>& turned_columns() {
  static const NumberFormat share = in_form("{:.1e}");
  static const Columns<RunPair> all =
      keys(true).add({{"", "sides", [](auto& p) { return or_dash(p.series.sides); }},
                      {"", "not turned", [](auto& p) { return reported(p.kind, *p.run); }},
                      {"", "turned over", [](auto& p) { return reported(p.kind, *p.other); }},
                      {"apart_at_contact", In::Both, &RunPair::value},
                      {"apart_end", In::Both, apart_at_end},
                      {"", "distance at contact / end [of L]",
                       [](auto& p) { return share(p.value) + " / " + share(apart_at_end(p)); }},
                      {"same", In::Both, same_from_both_sides},
                      {"", "result", turned_result}});
  return all;
}

/// Popping, or the status of a run that did not end well.
Value popping_of(const RunRecord& c) {
  return c.outcome.status == "ok" ? Value(summary_value(c, "pop_max_m")) : Value(c.outcome.status);
}

std::string popping_result(const RunPair& p) {
  if (!p.both_ok()) return "did not run";
  if (!std::isfinite(p.value)) return "not known";
  return popping_passed(p) ? "pass" : "fail";
}

const Columns<RunPair>& popping_columns() {
  static const Columns<RunPair> all =
      keys(false).add({{"pop_max_m", In::Both, summary("pop_max_m")},
                       {"pop_max_x16_m", In::Both, [](auto& p) { return summary_value(*p.other, "pop_max_m"); }},
                       {"", "popping", [](auto& p) { return popping_of(*p.run); }, digits(3), kMillimetres},
                       {"", "popping at ×16", [](auto& p) { return popping_of(*p.other); }, digits(3), kMillimetres},
                       {"verdict", "verdict", popping_result}});
  return all;
}

/// Device time of the stages that serve static meshes; NaN if there is none.
double mesh_stages_s(const RunRecord& c) {
  double sum = kMissing;
  for (const StageRecord& s : c.header.stages)
    if (contains(s.serves, "static_mesh")) {
      const double t = summary_value(c, "stage_device_median_s." + s.name);
      sum = std::isnan(sum) ? t : sum + t;
    }
  return sum;
}

/// What the two cost: key in JSON, head, unit.
struct RoomQuantity {
  const char *key, *head;
  double scale;
  double of(const RunRecord& c) const {
    return std::string(key) == "mesh_stages_s" ? mesh_stages_s(c) : summary_value(c, key);
  }
  std::string text(const RunRecord& c) const {
    if (c.outcome.status != "ok") return c.outcome.status;
    return std::string(key) == "read_B_per_frame" ? bytes_read(c, scale * of(c), 3) : significant(scale * of(c), 3);
  }
};

constexpr RoomQuantity kRoomQuantities[] = {{"frame_wall_median_s", "wall [ms]", 1e3},
                                            {"frame_device_median_s", "GPU [ms]", 1e3},
                                            {"mesh_stages_s", "mesh stages [ms]", 1e3},
                                            {"read_B_per_frame", "read [kB]", 1e-3},
                                            {"write_B_per_frame", "written [kB]", 1e-3},
                                            {"device_memory_B", "memory [kB]", 1e-3},
                                            {"load_s", "load [ms]", 1e3}};

std::string distance(double m) { return std::isfinite(m) ? fmt::format("{:.3g} m", m) : "not measured"; }

}  // namespace

std::vector<RunPair> turned_pairs(const std::vector<ContactSetUp>& ups) {
  std::vector<RunPair> out = run_pairs(contact_rows(ups), "turned-over");
  std::erase_if(out, [](const RunPair& p) { return is_floor(p.series.solver) || !ran(*p.run) || !ran(*p.other); });
  return out;
}

bool same_from_both_sides(const RunPair& p) {
  return p.both_ok() && leak_of(p.kind, *p.run).empty() == leak_of(p.kind, *p.other).empty() && p.within();
}

Table turned_table(const std::vector<RunPair>& pairs) {
  return turned_columns().table(
      {"The cloth turned over",
       with_withheld(
           "The same scene with axis_u and axis_v exchanged: the cloth's normals point the other way; its "
           "vertices and triangles start at the same places. The table has the verdict and the first failed "
           "bound of each run, and the RMS distance between vertices that started at the same places, divided "
           "by the longer side: the greatest value up to 0.1 s after the first contact, and the value at the "
           "end. Same: both runs fail or both pass, and the distance at contact is at most 0.05. Later, "
           "rounding decides to which side a fold tips. `clothbench metamorphic` (flip) bounds the effect of "
           "turning alone.",
           runs_of(pairs, &RunPair::run, &RunPair::other), {"crossings_max", "depth_max_m"}),
       {}},
      pairs);
}

json turned_json(const std::vector<RunPair>& pairs) { return turned_columns().json(pairs); }

std::vector<RunPair> popping_pairs(const std::vector<ContactSetUp>& ups) {
  std::vector<RunPair> out = run_pairs(contact_rows(ups), "finer");
  std::erase_if(out, [](const RunPair& p) { return !ran(*p.run); });
  return out;
}

bool popping_passed(const RunPair& p) { return p.both_ok() && p.within(); }

Table popping_table(const std::vector<RunPair>& all) {
  return popping_columns().table(
      {"Popping against the same solver at 16 times its substeps",
       with_withheld("Popping: greatest displacement of a vertex within 1/36 s beyond twice what its neighbours, "
                     "colliders and grips move in that time. ×16: the same with 16 times as many substeps a frame. "
                     "Pass: at most 1 cm more than at ×16.",
                     runs_of(all, &RunPair::run, &RunPair::other), {"pop_max_m"}),
       {}},
      all);
}

json popping_json(const std::vector<RunPair>& all) { return popping_columns().json(all); }

Table room_table(const std::vector<RunPair>& pairs) {
  struct Room {
    const RunPair* pair;
    const char* mesh;
    std::function<std::string(const RoomQuantity&)> text;
  };
  std::vector<Room> rows;
  std::string note;
  for (const RunPair& p : pairs) {
    rows.push_back({&p, "SubMesh", [&](auto& q) { return q.text(*p.run); }});
    rows.push_back({&p, "whole room", [&](auto& q) { return q.text(*p.other); }});
    rows.push_back({&p, "ratio", [&](auto& q) { return significant(q.of(*p.other) / q.of(*p.run), 3); }});
    note += fmt::format(
        "{}{}, {}: greatest distance between the positions of the two runs: {} at the end, {} over all "
        "frames.",
        note.empty() ? "" : " ", p.scene, p.series.label(), distance(p.apart.end), distance(p.value));
  }
  return Columns<Room>{{"", "scene", [](auto& r) { return r.pair->scene; }},
                       {"", "solver", [](auto& r) { return r.pair->series.label(); }},
                       {"", "mesh", &Room::mesh}}
      .across(kRoomQuantities, &RoomQuantity::head, [](const Room& r, const RoomQuantity& q) { return r.text(q); })
      .table({"SubMesh against the whole room (section 3.2.4)",
              with_withheld(note, runs_of(pairs, &RunPair::run, &RunPair::other), {"frame_wall_median_s", "load_s"}),
              {}},
             rows);
}

json room_json(const std::vector<RunPair>& pairs) {
  json out = json::array();
  for (const RunPair& p : pairs) {
    out.push_back({{"scene", p.scene},
                   {"solver", p.series.solver},
                   {"distance_end_m", finite_or_null(p.apart.end)},
                   {"distance_max_m", finite_or_null(p.value)}});
    for (const auto& [name, run] : {std::pair{"sub_mesh", p.run}, std::pair{"whole_room", p.other}}) {
      json& part = out.back()[name] = {{"setting", run->header.setting}, {"status", run->outcome.status}};
      for (const RoomQuantity& q : kRoomQuantities) part[q.key] = finite_or_null(q.of(*run));
    }
  }
  return out;
}

}  // namespace clothbench
