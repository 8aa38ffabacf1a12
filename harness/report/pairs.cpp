#include "report/pairs.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"
#include "metrics/metric.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

using nlohmann::json;
using Map = PairRelation::Map;

/// Positions of all frames, about `centre`, over `unit`.
struct Path {
  std::vector<float> position;
  double centre[3] = {}, unit = 1;
  double at(std::size_t k) const { return (double{position[k]} - centre[k % 3]) / unit; }
};

Path path_of(const RunRecord& c, Map map) {
  Path out;
  out.position =
      !c.accuracy.position.empty() || c.file.empty() ? c.accuracy.position : read_run(c.file).accuracy.position;
  if (map != Map::Shape) return out;
  const json cloth = scenario_of(c)["cloth"];
  out.unit = cloth["size_m"][0].get<double>();
  for (std::size_t k = 0; k < 3; ++k) out.centre[k] = cloth["pose"]["center_m"][k].get<double>();
  return out;
}

/// Two numbers of the cloth, such as its grid; none if it has no such pair.
std::optional<std::pair<double, double>> two_of(const RunRecord& c, const char* key) {
  const json scenario = scenario_of(c);
  const json j =
      scenario.is_object() ? scenario.value(json::json_pointer(std::string("/cloth/") + key), json()) : json();
  if (!j.is_array() || j.size() != 2) return std::nullopt;
  return std::pair{j[0].get<double>(), j[1].get<double>()};
}

Apart measure(const RunPair& p) {
  const Map map = p.relation->map;
  if (map == Map::None) return {};
  const auto grid = two_of(*p.run, "grid");
  if (map == Map::Transposed && !grid) return {};
  const Path a = path_of(*p.run, map), b = path_of(*p.other, map);
  const std::size_t vertices = p.run->header.vertices, all = a.position.size(),
                    columns = map == Map::Transposed ? static_cast<std::size_t>(grid->first) : 0;
  if (all == 0 || all != b.position.size() || vertices == 0 || all % (3 * vertices) != 0 ||
      (columns > 0 && vertices % columns != 0))
    return {};
  Apart out{0, 0, 0};
  for (std::size_t first = 0; first < all; first += 3 * vertices) {
    double sum = 0;
    out.end = 0;
    for (std::size_t v = 0; v < vertices; ++v) {
      const std::size_t there = columns == 0 ? v : (v % columns) * (vertices / columns) + v / columns;
      double squared = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double off = a.at(first + 3 * v + k) - b.at(first + 3 * there + k);
        squared += off * off;
        out.coordinate = max_or_nan(out.coordinate, std::abs(off));
      }
      sum += squared;
      out.end = max_or_nan(out.end, std::sqrt(squared));
    }
    out.rms.push_back(std::sqrt(sum / static_cast<double>(vertices)));
    out.most = max_or_nan(out.most, out.end);
  }
  return out;
}

/// Greatest RMS distance until 0.1 s after the first contact with a collider; NaN without contact, or if unknown.
double until_contact(const RunPair& p) {
  constexpr double kAtContact_s = 0.1;
  const std::vector<double>& rms = p.apart.rms;
  const AccuracyPass& pass = p.run->accuracy;
  for (const MetricSeries& m : pass.metrics) {
    if (m.name != "touching_fraction" || m.values.size() != rms.size() || pass.time_s.size() != rms.size()) continue;
    const auto first = std::find_if(m.values.begin(), m.values.end(), [](double v) { return !(v <= 0); });
    if (first == m.values.end()) return kMissing;
    const double end_s = pass.time_s[static_cast<std::size_t>(first - m.values.begin())] + kAtContact_s;
    double most = 0;
    for (std::size_t f = 0; f < rms.size() && pass.time_s[f] <= end_s; ++f) most = max_or_nan(most, rms[f]);
    return most / longer_side(*p.run);
  }
  return kMissing;
}

double ratio(const RunRecord& above, const RunRecord& below, const char* name) {
  const double v = summary_value(below, name);
  return v > 0 ? summary_value(above, name) / v : kMissing;
}

double coordinate(const RunPair& p) { return p.apart.coordinate; }

/// 0, or that it is no pair.
double pair_if(bool is) { return is ? 0 : INFINITY; }

bool alike(const Series& a, const Series& b) {
  return a.solver == b.solver && a.setting == b.setting && a.sides == b.sides;
}

double formerly_turned(const ContactRow& o, const json&, const ContactRow& r, const json&) {
  return pair_if(o.scene == r.scene + "-turned" && alike(o.series, r.series));
}

double formerly_finer(const ContactRow& o, const json&, const ContactRow& r, const json&) {
  Series s = r.series;
  s.setting = "x16";
  return pair_if(r.series.setting == "default" && o.scene == r.scene && alike(o.series, s));
}

bool same_settings(const ContactRow& a, const ContactRow& b) {
  return a.run->header.solver == b.run->header.solver && a.run->header.settings == b.run->header.settings;
}

/// Whether a room is whole (`cut` is "none"); none without a room. Erases the cuts.
std::optional<bool> take_cut(json& scenario) {
  std::optional<bool> whole;
  if (!scenario.is_object() || !scenario.contains("colliders") || !scenario["colliders"].is_array()) return whole;
  for (json& collider : scenario["colliders"]) {
    if (!collider.is_object() || collider.value("type", "") != "room") continue;
    whole = collider.value("cut", "") == "none";
    collider.erase("cut");
  }
  return whole;
}

double formerly_whole(const ContactRow& o, const json& its, const ContactRow& r, const json& scenario) {
  if (o.run->header.solver != r.run->header.solver) return INFINITY;
  json whole = its, cut = scenario;
  return pair_if(take_cut(whole) == true && take_cut(cut) == false && whole == cut && same_settings(o, r));
}

std::filesystem::path folder(const RunRecord& c) { return std::filesystem::path(c.file).parent_path(); }

double formerly_irrelevant(const ContactRow& o, const json& its, const ContactRow& r, const json&) {
  if (!its.is_object() || !its.contains("irrelevant") || o.scene != r.scene) return INFINITY;
  const std::string& plain = r.run->header.setting;
  return pair_if(o.run->header.setting == (plain == "default" ? "all-on" : plain + ",all-on") &&
                 folder(*o.run) == folder(*r.run) && same_settings(o, r));
}

/// Whether both are runs of this case of stability at one setting.
bool both_of(const char* name, const ContactRow& o, const json& its, const ContactRow& r, const json& scenario) {
  const auto is = [&](const json& s) {
    return s.is_object() && s.contains("stability") && s["stability"].value("case", "") == name;
  };
  return is(its) && is(scenario) && o.run->header.solver == r.run->header.solver &&
         o.run->header.setting == r.run->header.setting;
}

double simulated_s(const json& scenario) {
  const json& time = scenario["time"];
  const double more =
      time.contains("hitch") ? time["hitch"]["dt_s"].get<double>() - 1 / time["frame_rate_hz"].get<double>() : 0;
  return time["duration_s"].get<double>() + more;
}

/// The even run whose duration is nearest.
double formerly_even(const ContactRow& o, const json& its, const ContactRow& r, const json& scenario) {
  const auto even = [](const json& s) { return !s["time"].contains("hitch") && !s["time"].contains("jitter"); };
  if (!both_of("S22", o, its, r, scenario) || even(its) || !even(scenario)) return INFINITY;
  return std::abs(simulated_s(scenario) - simulated_s(its));
}

double formerly_scale(const ContactRow& o, const json& its, const ContactRow& r, const json& scenario) {
  const auto metre = [](const json& s) { return s["cloth"]["size_m"][0].get<double>() == 1; };
  return pair_if(both_of("S24", o, its, r, scenario) && metre(scenario) && !metre(its));
}

/// The run with the coarsest cells that ended well.
double formerly_coarser(const ContactRow& o, const json& its, const ContactRow& r, const json& scenario) {
  const auto cells = [](const json& s) { return s["cloth"]["grid"][0].get<double>(); };
  const bool is = both_of("S25", o, its, r, scenario) && r.run->outcome.status == "ok" && cells(scenario) < cells(its);
  return is ? cells(scenario) : INFINITY;
}

double seed_of(const json& scenario) { return scenario["cloth"]["start"].value("seed", 0); }

double formerly_repeat(const ContactRow& o, const json& its, const ContactRow& r, const json& scenario) {
  return pair_if(both_of("S26", o, its, r, scenario) && seed_of(its) == seed_of(scenario));
}

/// A mesh against the grid of as many vertices and the same material, at one setting.
double formerly_grid(const ContactRow& o, const json& its, const ContactRow& r, const json& scenario) {
  const auto has = [](const json& s, const char* key) { return s.is_object() && s["cloth"].contains(key); };
  return pair_if(has(its, "mesh") && has(scenario, "grid") && its["material"] == scenario["material"] &&
                 o.run->header.vertices == r.run->header.vertices && o.run->header.vertices > 0 && same_settings(o, r));
}

/// Never of one study.
double formerly_none(const ContactRow&, const json&, const ContactRow&, const json&) { return INFINITY; }

/// The run with the least seed.
double formerly_seed(const ContactRow& o, const json& its, const ContactRow& r, const json& scenario) {
  const bool is = both_of("S26", o, its, r, scenario) && seed_of(scenario) < seed_of(its);
  return is ? seed_of(scenario) : INFINITY;
}

double most_over_side(const RunPair& p) { return p.apart.most / longer_side(*p.run); }

double popping_m(const RunRecord& c) { return summary_value(c, "pop_max_m"); }

const PairRelation kRelations[] = {
    {"turned-over", Map::Transposed, until_contact, 0.05, formerly_turned},
    {"whole-room", Map::Same, [](const RunPair& p) { return p.apart.most; }, kMissing, formerly_whole},
    {"irrelevant", Map::Same, most_over_side, 1e-6, formerly_irrelevant},
    {"finer", Map::None, [](const RunPair& p) { return popping_m(*p.run) - popping_m(*p.other); }, 0.01,
     formerly_finer},
    {"even-frames", Map::None, [](const RunPair& p) { return ratio(*p.other, *p.run, "truth_e2"); }, 3, formerly_even},
    {"scale", Map::Shape, coordinate, 0, formerly_scale},
    {"resolution", Map::None, [](const RunPair& p) { return ratio(*p.other, *p.run, "stretch_max_last_second"); },
     kMissing, formerly_coarser},
    {"repeat", Map::Shape, coordinate, 0, formerly_repeat},
    {"seed", Map::Shape, coordinate, kMissing, formerly_seed},
    {"grid", Map::None, [](const RunPair& p) { return ratio(*p.other, *p.run, "frame_device_median_s"); }, kMissing,
     formerly_grid},
    {"before", Map::Same, most_over_side, 0, formerly_none}};

const PairRelation& relation_of(const std::string& name) {
  const auto at = std::find_if(std::begin(kRelations), std::end(kRelations), [&](auto& r) { return r.name == name; });
  if (at == std::end(kRelations)) throw Error("no relation of two runs is called " + name);
  return *at;
}

RunPair measured(const ContactRow& run, const RunRecord& other, const PairRelation& relation) {
  RunPair p{run, &other, &relation};
  p.apart = measure(p);
  p.value = relation.value(p);
  return p;
}

ContactRow plain_row(const RunRecord& c) { return {&c, {c.header.solver, c.header.setting, ""}, "", c.header.scene}; }

struct Seen {
  const ContactRow* row;
  json scenario, pairs;  ///< pairs: what its study file compares it with; null: nothing

  explicit Seen(const ContactRow& r) : row(&r), scenario(scenario_of(*r.run)) {
    if (const json& e = r.run->header.environment; e.is_object()) pairs = e.value("pairs", json());
  }

  /// Infinite if it is not compared with `r`; of several, the one with the least value is.
  double to(const Seen& r, const PairRelation& relation) const {
    const bool together = folder(*row->run) == folder(*r.row->run);
    const RunHeader &own = row->run->header, &its = r.row->run->header;
    constexpr double kElsewhere = 1e9;
    if (pairs.is_null()) return relation.formerly(*row, scenario, *r.row, r.scenario) + (together ? 0 : kElsewhere);
    for (const json& p : pairs) {
      if (p.at("relation") != relation.name || !together || own.solver != its.solver) continue;
      const json &scenes = p.at("with").at("scene"), &settings = p.at("with").at("setting");
      const auto scene = std::find(scenes.begin(), scenes.end(), its.scene),
                 setting = std::find(settings.begin(), settings.end(), its.setting);
      if (scene != scenes.end() && setting != settings.end())
        return static_cast<double>((scene - scenes.begin()) + (setting - settings.begin()));
    }
    return INFINITY;
  }
};

}  // namespace

double longer_side(const RunRecord& c) {
  const auto size = two_of(c, "size_m");
  return size ? std::max(size->first, size->second) : kMissing;
}

bool RunPair::within() const { return value <= relation->bound; }

std::vector<RunPair> run_pairs(const std::vector<ContactRow>& rows, const std::string& name) {
  const PairRelation& relation = relation_of(name);
  std::vector<Seen> seen;
  for (const ContactRow& r : rows)
    if (r.run->outcome.status != "missing") seen.emplace_back(r);
  std::vector<std::pair<const Seen*, RunPair>> found;
  for (const Seen& o : seen) {
    const Seen* with = nullptr;
    double least = INFINITY;
    for (const Seen& r : seen) {
      // Of two that could each be compared with the other, the first is the one as it is.
      if (&r == &o || (&r > &o && std::isfinite(r.to(o, relation)))) continue;
      if (const double far = o.to(r, relation); far < least) {
        least = far;
        with = &r;
      }
    }
    if (with == nullptr) continue;
    found.emplace_back(with, measured(*with->row, *o.row->run, relation));
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<RunPair> out;
  for (auto& [with, p] : found) out.push_back(std::move(p));
  return out;
}

std::vector<RunPair> run_pairs(const std::vector<RunRecord>& runs, const std::string& relation) {
  std::vector<ContactRow> rows;
  for (const RunRecord& c : runs) rows.push_back(plain_row(c));
  return run_pairs(rows, relation);
}

RunPair pair_of(const RunRecord& run, const RunRecord& other, const std::string& relation) {
  return measured(plain_row(run), other, relation_of(relation));
}

}  // namespace clothbench
