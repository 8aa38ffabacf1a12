#include "report/turned.hpp"

#include <algorithm>
#include <cmath>

#include "report/trajectories.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

const std::string kSuffix = "-turned";
constexpr double kSamePlace = 0.05, kAtContact_s = 0.1;

/// Greatest of `rms_m` until kAtContact_s after the first contact with a collider; NaN without contact, or if unknown.
double until_contact(const RunRecord& c, const std::vector<double>& rms_m) {
  for (const MetricSeries& m : c.accuracy.metrics) {
    if (m.name != "touching_fraction" || m.values.size() != rms_m.size() || c.accuracy.time_s.size() != rms_m.size())
      continue;
    const auto first = std::find_if(m.values.begin(), m.values.end(), [](double v) { return !(v <= 0); });
    if (first == m.values.end()) return kMissing;
    const double end_s = c.accuracy.time_s[static_cast<std::size_t>(first - m.values.begin())] + kAtContact_s;
    double most = 0;
    for (std::size_t f = 0; f < rms_m.size() && c.accuracy.time_s[f] <= end_s; ++f)
      most = rms_m[f] <= most ? most : rms_m[f];
    return most;
  }
  return kMissing;
}

bool ran(const RunRecord& c) { return c.outcome.status != "unsupported" && c.outcome.status != "missing"; }

/// Verdict, and the leak if there is one.
std::string reported(const std::string& kind, const RunRecord& c) {
  const std::string leak = c.outcome.status == "ok" ? leak_of(kind, c) : "";
  return verdict(c) + (leak.empty() || leak == kNotPrinted ? "" : " (" + leak + ")");
}

std::string result(const TurnedPair& p) {
  for (const RunRecord* c : {p.run, p.turned})
    if (leak_of(p.kind, *c) == kNotPrinted) return kNotPrinted;
  return p.same() ? "same" : "differs";
}

TurnedPair pair_of(const std::string& kind, const std::string& scene, const ContactRow& flat,
                   const ContactRow& turned) {
  TurnedPair p{kind, scene, flat.series, flat.run, turned.run};
  const json s = scenario_of(*flat.run);
  const json grid = s.value(json::json_pointer("/cloth/grid"), json()),
             size = s.value(json::json_pointer("/cloth/size_m"), json());
  if (!grid.is_array() || grid.size() != 2 || !size.is_array() || size.size() != 2) return p;
  const double side_m = std::max(size[0].get<double>(), size[1].get<double>());
  const std::vector<double> rms_m = trajectories_apart(*flat.run, *turned.run, grid[0].get<std::size_t>()).rms_m;
  if (rms_m.empty()) return p;
  p.apart_at_contact = until_contact(*flat.run, rms_m) / side_m;
  p.apart_end = rms_m.back() / side_m;
  return p;
}

const Columns<TurnedPair>& turned_columns() {
  static const NumberFormat share = in_form("{:.1e}");
  static const Columns<TurnedPair> all = {
      {"scene", "scene", &TurnedPair::scene},
      {"solver", In::Both, [](auto& p) { return p.series.solver; }},
      {"setting", In::Both, [](auto& p) { return p.series.setting; }},
      {"sides", In::Both, [](auto& p) { return p.series.sides; }},
      {"", "solver", [](auto& p) { return p.series.label(); }},
      {"", "sides", [](auto& p) { return or_dash(p.series.sides); }},
      {"", "as it is", [](auto& p) { return reported(p.kind, *p.run); }},
      {"", "turned over", [](auto& p) { return reported(p.kind, *p.turned); }},
      {"apart_at_contact", In::Both, &TurnedPair::apart_at_contact},
      {"apart_end", In::Both, &TurnedPair::apart_end},
      {"", "apart, contact / end [of L]",
       [](auto& p) { return share(p.apart_at_contact) + " / " + share(p.apart_end); }},
      {"same", In::Both, &TurnedPair::same},
      {"", "result", result}};
  return all;
}

}  // namespace

bool TurnedPair::same() const {
  return run->outcome.status == "ok" && turned->outcome.status == "ok" &&
         leak_of(kind, *run).empty() == leak_of(kind, *turned).empty() && apart_at_contact <= kSamePlace;
}

std::vector<TurnedPair> turned_pairs(const std::vector<ContactSetUp>& ups) {
  std::vector<TurnedPair> out;
  for (const ContactSetUp& u : ups)
    for (const ContactScene& s : u.scenes)
      for (const ContactScene& t : u.scenes) {
        if (t.name != s.name + kSuffix) continue;
        for (const ContactRow& a : s.rows)
          for (const ContactRow& b : t.rows)
            if (a.series == b.series && a.series.solver != "ballistic" && ran(*a.run) && ran(*b.run))
              out.push_back(pair_of(u.kind, s.name, a, b));
      }
  return out;
}

Table turned_table(const std::vector<TurnedPair>& pairs) {
  return turned_columns().table(
      {"The cloth turned over",
       with_withheld(
           "The same scene with axis_u and axis_v changed for one another: the cloth's normals point the other way, "
           "its "
           "vertices and triangles "
           "begin where they did. What each of the two keeps of what the scene expects, and its leak; distance of the "
           "vertices that began in "
           "the same places, RMS over the cloth, over its longer side: the most up to 0.1 s after the first contact / "
           "at the end. Same: both "
           "leak or neither, and at most 0.05 apart at contact; later a fold tips whichever way rounding sends it. "
           "What "
           "turning alone does to "
           "a solver, `clothbench metamorphic` (flip) bounds.",
           runs_of(pairs, &TurnedPair::run, &TurnedPair::turned),
           {"tunnelled_fraction_max", "wrong_side_samples_max", "depth_vertex_max_m"}),
       {}},
      pairs);
}

json turned_json(const std::vector<TurnedPair>& pairs) { return turned_columns().json(pairs); }

}  // namespace clothbench
