#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "base/words.hpp"
#include "report/grid.hpp"
#include "report/roles.hpp"
#include "report/work_precision.hpp"

namespace clothbench {
namespace {

std::set<std::string> ranked(const WorkDiagram& d) {
  std::set<std::string> out;
  if (!d.refused().empty()) return out;
  for (const WorkPoint& p : d.points)
    if (!is_baseline(p.solver) && p.not_ranked.empty() && p.took_part()) out.insert(p.solver);
  return out;
}

/// Ranking criterion of a solver: the least value over its points; infinity if no point counts.
struct Criterion {
  const char* name;
  std::function<double(const WorkDiagram&, const WorkPoint&)> value;  ///< infinity: the point does not count
};

Criterion time_to(const char* name, double error) {
  return {name,
          [error](const WorkDiagram&, const WorkPoint& p) { return p.error <= error ? p.wall_ms_per_s : INFINITY; }};
}

const std::vector<Criterion>& criteria() {
  static const std::vector<Criterion> all = {time_to("time to 1 %", 1e-2),
                                             time_to("time to 0.1 %", 1e-3),
                                             {"error in real time", [](const WorkDiagram& d, const WorkPoint& p) {
                                                return in_real_time(p) ? std::max(p.error, d.rank_floor()) : INFINITY;
                                              }}};
  return all;
}

double least(const WorkDiagram& d, const std::string& solver, const Criterion& c) {
  double out = INFINITY;
  for (const WorkPoint& p : d.points)
    if (p.solver == solver && p.ranks()) out = std::min(out, c.value(d, p));
  return out;
}

/// Rank of a solver, 1 for the best; equal values share the best of their ranks.
int rank(const WorkDiagram& d, const std::string& solver, const Criterion& c) {
  int better = 0;
  for (const std::string& other : ranked(d)) better += least(d, other, c) < least(d, solver, c);
  return 1 + better;
}

}  // namespace

Table winners_table(const std::vector<WorkDiagram>& diagrams) {
  static const auto winners = [](const WorkDiagram& d, const Criterion& c) -> std::string {
    std::string names;
    double value = INFINITY;
    for (const std::string& s : ranked(d))
      if (rank(d, s, c) == 1 && std::isfinite(least(d, s, c))) {
        names += (names.empty() ? "" : ", ") + s;
        value = least(d, s, c);
      }
    const bool at_floor = &c == &criteria().back() && value <= d.rank_floor();
    return names.empty() ? "" : fmt::format("{} ({}{:.2g})", names, at_floor ? "≤ " : "", value);
  };
  Columns<WorkDiagram> columns = {{"", "scene", &WorkDiagram::scene},
                                  {"", "solvers ranked", [](auto& d) {
                                     return d.refused().empty() ? std::to_string(ranked(d).size()) : "refused";
                                   }}};
  for (const Criterion& c : criteria())
    columns.push_back({"", c.name, [&c](auto& d) { return or_dash(winners(d, c)); }});
  return columns
      .add({{"", "not ranked",
             [](auto& d) { return or_dash(joined(d.flagged, ", ", [](auto& flag) { return flag.first; })); }}})
      .table({"Best solver by scene",
              "Best of the ranked solvers; several names where they are not distinguished. Times: ms of wall time "
              "per simulated second. ≤: at the floor.",
              {}},
             diagrams);
}

Table ranks_table(const std::vector<WorkDiagram>& diagrams) {
  std::set<std::string> all;
  for (const WorkDiagram& d : diagrams) all.merge(ranked(d));
  const auto ranking = [&](const std::string& solver) {
    std::vector<const WorkDiagram*> out;
    for (const WorkDiagram& d : diagrams)
      if (ranked(d).contains(solver)) out.push_back(&d);
    return out;
  };
  Columns<std::string> columns = {{"", "solver", [](auto& s) { return s; }},
                                  {"", "scenes", [&](auto& s) { return ranking(s).size(); }}};
  for (const Criterion& c : criteria())
    columns.push_back({"", std::string("rank by ") + c.name,
                       [&](auto& s) {
                         double sum = 0;
                         for (const WorkDiagram* d : ranking(s)) sum += std::log(rank(*d, s, c));
                         return std::exp(sum / static_cast<double>(ranking(s).size()));
                       },
                       in_form("{:.2f}")});
  return columns.table({"Ranks",
                        "Geometric mean of the ranks over the scenes that rank the solver; 1: first in every scene. "
                        "Errors of different scenes are not averaged.",
                        {}},
                       all);
}

}  // namespace clothbench
