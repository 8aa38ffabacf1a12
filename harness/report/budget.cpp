#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "report/grid.hpp"
#include "report/work_precision.hpp"

namespace clothbench {
namespace {

// From the cost of one dispatch with its submission to the display time of a headset's frame.
constexpr double kLeastBudget_ms = 0.05, kMostBudget_ms = 13.9;
constexpr std::array kBudgets_ms = {kLeastBudget_ms, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, kMostBudget_ms};
// All errors below it are small enough for real-time use.
constexpr double kSmallEnough = 1e-3;

struct Best {
  double error = INFINITY;
  const WorkPoint* point = nullptr;
};

Best best_within(const WorkDiagram& d, const std::string& solver, double budget_ms) {
  const double floor = std::max(kSmallEnough, d.rank_floor());
  Best out;
  for (const WorkPoint& p : d.points)
    if (p.solver == solver && p.counts() && p.frame_ms <= budget_ms && p.error < out.error) out = {p.error, &p};
  if (out.point != nullptr) out.error = std::max(out.error, floor);
  return out;
}

/// The solver with the smallest error relative to that of `solver` at any budget: name, error ratio and budget.
std::string beaten_by(const WorkDiagram& d, const std::string& solver) {
  double worst = 1;
  std::string out = "never";
  for (const WorkPoint& p : d.points) {
    if (p.solver == solver || !p.counts() || p.frame_ms > kMostBudget_ms) continue;
    const double budget = std::max(p.frame_ms, kLeastBudget_ms);
    const double theirs = best_within(d, p.solver, budget).error, ours = best_within(d, solver, budget).error;
    // Clocks of one machine agree only to about this factor.
    const double factor = ours / theirs;
    if (!(factor > std::max(worst, 1.001))) continue;
    worst = factor;
    out = std::isinf(factor)
              ? fmt::format("{}: {:.2g} at {:.3g} ms, where this solver has no result", p.solver, theirs, budget)
              : fmt::format("{}: {:.3g} times at {:.3g} ms", p.solver, factor, budget);
    if (!p.not_ranked.empty()) out += " (not ranked)";
  }
  return out;
}

}  // namespace

Table budget_table(const std::vector<WorkDiagram>& diagrams) {
  return Columns<SolverOfScene>{{"", "scene", &SolverOfScene::scene}, {"", "solver", &SolverOfScene::solver}}
      .across(
          kBudgets_ms, [](double b) { return fmt::format("{:g} ms", b); },
          [](const SolverOfScene& s, double budget_ms) {
            const Best best = best_within(*s.diagram, s.solver, budget_ms);
            const bool at_floor = best.error <= std::max(kSmallEnough, s.diagram->rank_floor());
            return best.point == nullptr ? "" : fmt::format("{}{:.2g}", at_floor ? "≤ " : "", best.error);
          })
      .add({{"", "beaten by", [](auto& s) { return beaten_by(*s.diagram, s.solver); }}})
      .table({"Smallest error within a time budget per frame",
              "Smallest error among the settings of a solver whose frame takes at most this wall time; frames are "
              "pipelined where the solver can. ≤: the error is at most 0.001 or at the scene's floor, below which "
              "solvers are not distinguished. –: no setting is that fast. Beaten by: the other solver, ranked or "
              "not, with the smaller error at a budget from 0.05 to 13.9 ms, and the greatest ratio of the two "
              "errors.",
              {}},
             solvers_of(diagrams));
}

Table energy_table(const std::vector<WorkDiagram>& diagrams) {
  struct Gain : SolverOfScene {
    double most = -1;
    int above = 0, all = 0;
    std::string setting = {};
  };
  std::vector<Gain> gains;
  for (const SolverOfScene& s : solvers_of(diagrams)) {
    Gain g{s};
    for (const WorkPoint& p : s.diagram->points) {
      if (p.solver != s.solver || !p.counts() || !std::isfinite(p.energy_gain)) continue;
      ++g.all;
      g.above += !(p.energy_gain <= 1e-3);
      if (p.energy_gain > g.most) {
        g.most = p.energy_gain;
        g.setting = p.setting;
      }
    }
    if (g.all > 0) gains.push_back(std::move(g));
  }
  return Columns<Gain>{{"", "scene", &Gain::scene},
                       {"", "solver", &Gain::solver},
                       {"", "greatest gain", &Gain::most, in_form("{:.1e}")},
                       {"", "setting", &Gain::setting},
                       {"", "settings above 0.001", [](auto& g) { return fmt::format("{} of {}", g.above, g.all); }}}
      .table({"Energy gain where energy is conserved",
              "Greatest gain of total energy over its value at the start, in any frame, divided by M g L, and the "
              "setting that shows it. Only scenes that conserve energy and settings that ended ok. Last column: "
              "the number of settings with a gain above 0.001.",
              {}},
             gains);
}

}  // namespace clothbench
