#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "report/roles.hpp"
#include "report/work_precision.hpp"

namespace clothbench {
namespace {

std::set<std::string> ranked(const WorkDiagram& d) {
  std::set<std::string> out;
  if (!d.refused().empty()) return out;
  for (const WorkPoint& p : d.points) {
    const std::string& status = p.run->outcome.status;
    if (!is_baseline(p.solver) && !d.flagged.contains(p.solver) && status != "unsupported" && status != "missing")
      out.insert(p.solver);
  }
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
    if (p.solver == solver && p.counts()) out = std::min(out, c.value(d, p));
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
  Table t{"Best solver by scene",
          "Best of the ranked solvers; several names where they are not distinguished. Times: ms of wall time "
          "per simulated second. ≤: at the floor.",
          {{"scene", "solvers ranked"}}};
  for (const Criterion& c : criteria()) t.rows[0].emplace_back(c.name);
  t.rows[0].emplace_back("not ranked");
  for (const WorkDiagram& d : diagrams) {
    const std::set<std::string> able = ranked(d);
    std::vector<std::string> row = {d.scene, d.refused().empty() ? std::to_string(able.size()) : "refused"};
    for (const Criterion& c : criteria()) {
      std::string names;
      double value = INFINITY;
      for (const std::string& s : able)
        if (rank(d, s, c) == 1 && std::isfinite(least(d, s, c))) {
          names += (names.empty() ? "" : ", ") + s;
          value = least(d, s, c);
        }
      const bool is_error = &c == &criteria().back();
      row.push_back(names.empty()
                        ? "–"
                        : fmt::format("{} ({}{:.2g})", names, is_error && value <= d.rank_floor() ? "≤ " : "", value));
    }
    std::string flagged;
    for (const auto& [solver, why] : d.flagged) flagged += (flagged.empty() ? "" : ", ") + solver;
    row.push_back(flagged.empty() ? "–" : flagged);
    t.rows.push_back(std::move(row));
  }
  return t;
}

Table ranks_table(const std::vector<WorkDiagram>& diagrams) {
  Table t{"Ranks",
          "Geometric mean of the ranks over the scenes that rank the solver; 1: first in every scene. Errors "
          "of different scenes are not averaged.",
          {{"solver", "scenes"}}};
  for (const Criterion& c : criteria()) t.rows[0].push_back(std::string("rank by ") + c.name);
  std::set<std::string> all;
  for (const WorkDiagram& d : diagrams) all.merge(ranked(d));
  for (const std::string& solver : all) {
    int scenes = 0;
    std::vector<double> logs(criteria().size(), 0);
    for (const WorkDiagram& d : diagrams) {
      if (!ranked(d).contains(solver)) continue;
      ++scenes;
      for (std::size_t k = 0; k < logs.size(); ++k) logs[k] += std::log(rank(d, solver, criteria()[k]));
    }
    std::vector<std::string> row = {solver, std::to_string(scenes)};
    for (const double sum : logs) row.push_back(fmt::format("{:.2f}", std::exp(sum / scenes)));
    t.rows.push_back(std::move(row));
  }
  return t;
}

}  // namespace clothbench
