#include "report/work_precision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "base/json_number.hpp"
#include "report/grid.hpp"
#include "report/report.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr double kRealTime_ms_per_s = 1000;  // a 72 Hz frame simulates 1/72 s in 1/72 s

std::string card_of(const json& scenario) {
  return scenario.is_object() ? scenario.value(json::json_pointer("/truth/card"), std::string()) : "";
}

/// What ranks a card's runs; the cards themselves are in harness/truth/card.hpp, a report reads only files.
std::string ranking_of(const std::string& card) {
  if (card == "heavy-strip") return "stretch of the strip at rest / its truth";
  if (card == "two-hand-pull") return "greatest strain, RMS over time / (v0/c)";
  if (card == "incline") return "way along the slope, RMS over time / way at the end (at rest: L)";
  if (card == "capstan" || card == "atwood")
    return "way over the cylinder, RMS over time / way at the end (at rest: L)";
  return card == "catenary" || card == "cantilever" ? "RMS distance at rest / L"
                                                    : "RMS distance over space and time / L";
}

WorkPoint point_of(const CellRecord& c, const json& scenario) {
  WorkPoint p;
  p.cell = &c;
  p.solver = c.header.solver;
  p.setting = c.header.setting;
  p.ok = c.outcome.status == "ok";
  p.device_ms_per_s = kMissing;
  const double frames_per_s = scenario.value(json::json_pointer("/time/frame_rate_hz"), kMissing);
  p.fenced_ms_per_s = 1e3 * frames_per_s * summary_value(c, "frame_wall_median_s");
  const double pipelined = 1e3 * frames_per_s * summary_value(c, "frame_pipelined_median_s");
  p.wall_ms_per_s = std::isfinite(pipelined) ? pipelined : p.fenced_ms_per_s;
  p.device_ms_per_s = 1e3 * frames_per_s * summary_value(c, "frame_device_median_s");
  p.on_gpu = std::isfinite(p.device_ms_per_s);
  p.frame_ms = p.wall_ms_per_s / frames_per_s;
  p.error = summary_value(c, "truth_error");
  p.energy_gain = summary_value(c, "energy_gain");
  return p;
}

bool drawn(const WorkPoint& p) { return p.ok && std::isfinite(p.error) && std::isfinite(p.wall_ms_per_s); }

void mark_front(std::vector<WorkPoint>& points) {
  for (WorkPoint& p : points) {
    p.on_front = drawn(p);
    for (const WorkPoint& q : points)
      if (q.solver == p.solver && drawn(q) && q.wall_ms_per_s <= p.wall_ms_per_s && q.error <= p.error &&
          (q.wall_ms_per_s < p.wall_ms_per_s || q.error < p.error))
        p.on_front = false;
  }
}

const WorkPoint* best(const WorkDiagram& d, const std::string& solver,
                      const std::function<bool(const WorkPoint&)>& counts, double WorkPoint::*by) {
  const WorkPoint* out = nullptr;
  for (const WorkPoint& p : d.points)
    if (p.solver == solver && drawn(p) && counts(p) && (out == nullptr || p.*by < out->*by)) out = &p;
  return out;
}

/// "64×1" of "substeps=64,iterations=1"; any other setting as it is.
std::string short_setting(const WorkPoint& p) {
  const std::string first = "substeps=", second = ",iterations=";
  const std::size_t at = p.setting.find(second);
  if (!p.setting.starts_with(first)) return p.setting;
  if (at == std::string::npos) return p.setting.substr(first.size());
  return p.setting.substr(first.size(), at - first.size()) + "×" + p.setting.substr(at + second.size());
}

std::string time_text(const WorkPoint* p, double WorkPoint::*clock = &WorkPoint::wall_ms_per_s) {
  return p == nullptr ? "–" : fmt::format("{:.3g} ({})", p->*clock, short_setting(*p));
}

auto within(double most) {
  return [most](const WorkPoint& p) { return p.error <= most; };
}
bool timed_on_gpu(const WorkPoint& p) { return std::isfinite(p.device_ms_per_s); }

std::string error_number(double v) { return std::isfinite(v) ? fmt::format("{:.1e}", v) : "–"; }

/// Errors are not distinguished below the floor.
std::string error_text(const WorkDiagram& d, const WorkPoint* p) {
  if (p == nullptr) return "–";
  const bool below = p->error < d.rank_floor();
  return fmt::format("{}{:.2g} ({})", below ? "≤ " : "", below ? d.rank_floor() : p->error, short_setting(*p));
}

std::vector<std::string> solvers_of(const WorkDiagram& d) {
  std::vector<std::string> out;
  for (const WorkPoint& p : d.points)
    if (std::find(out.begin(), out.end(), p.solver) == out.end()) out.push_back(p.solver);
  return out;
}

std::string failed_text(std::size_t failed, std::size_t all, std::size_t over_budget) {
  return fmt::format("{} of {}", failed, all) + (over_budget > 0 ? fmt::format(", {} not run", over_budget) : "");
}

std::vector<const CellRecord*> cells_of(const std::vector<WorkDiagram>& diagrams) {
  std::vector<const CellRecord*> out;
  for (const WorkDiagram& d : diagrams)
    for (const WorkPoint& p : d.points) out.push_back(p.cell);
  return out;
}

}  // namespace

bool in_real_time(const WorkPoint& p) { return p.wall_ms_per_s <= kRealTime_ms_per_s; }

double WorkDiagram::best_error() const {
  double least = kMissing;
  for (const WorkPoint& p : points)
    if (drawn(p) && p.solver != "reference" && !flagged.contains(p.solver) && !(least <= p.error)) least = p.error;
  return least;
}

double WorkDiagram::rank_floor() const {
  double most = 0;
  for (const double f : {floor(), space_error})
    if (f > most) most = f;
  return most;
}

std::string WorkDiagram::refused() const {
  if (!std::isfinite(uncertainty)) return "no reference solution";
  // The truth is exact where the reference confirms it, so only the uncertainty of the reference counts here. No solver
  // is ranked below the error of the mesh, so the reference need not be more certain than that.
  const double best = best_error();
  if (!std::isfinite(best)) return "no solver that is judged on it has an error";
  const double least = std::max(best, std::isfinite(space_error) ? space_error : 0.0);
  if (!(floor() < least)) return fmt::format("3 U_ref {:.1e} is not below the best error {:.1e}", floor(), least);
  return "";
}

bool has_truth(const CellRecord& c) { return !card_of(scenario_of(c)).empty(); }

std::vector<WorkDiagram> work_diagrams(const std::vector<CellRecord>& cells,
                                       const std::vector<SolverMaterial>& materials) {
  std::vector<WorkDiagram> out;
  for (const CellRecord& c : cells) {
    const json scenario = scenario_of(c);
    const std::string card = card_of(scenario);
    if (card.empty()) continue;
    auto at = std::find_if(out.begin(), out.end(), [&](const WorkDiagram& d) { return d.scene == c.header.scene; });
    if (at == out.end()) {
      out.push_back({c.header.scene, card, ranking_of(card), {}});
      at = out.end() - 1;
    }
    if (std::string why = stiffness_flag(materials, c.header.solver, stiffness_need(c)); !why.empty())
      at->flagged[c.header.solver] = std::move(why);
    at->points.push_back(point_of(c, scenario));
    if (!at->need.any()) at->need = stiffness_need(c);
    const auto take = [&](double& to, const char* name) {
      if (!std::isfinite(to)) to = summary_value(c, name);
    };
    take(at->space_error, "truth_space_error");
    take(at->uncertainty, "reference_uncertainty");
    take(at->truth_distance, "reference_truth_distance");
    take(at->order_bdf2, "reference_order_bdf2");
    take(at->order_conservative, "reference_order_conservative");
  }
  for (WorkDiagram& d : out) {
    mark_front(d.points);
    std::stable_sort(d.points.begin(), d.points.end(), [](const WorkPoint& a, const WorkPoint& b) {
      if (a.solver != b.solver) return a.solver < b.solver;
      return a.wall_ms_per_s < b.wall_ms_per_s;
    });
  }
  return out;
}

Table work_table(const std::vector<WorkDiagram>& diagrams) {
  Table t{
      "Error against run time",
      "Times in ms of wall time per simulated second, frames pipelined (two in flight) where a solver can; in "
      "brackets substeps × "
      "iterations. Fenced: each frame from submission to fence, waited for before the next. GPU: by the device's "
      "own clock. Errors are against the exact answer of the same mesh. In real time: a frame of 1/72 s takes at "
      "most 1/72 s. "
      "≤: below what tells solvers apart, three times the reference's uncertainty or the mesh's own error. Failed: "
      "cells without "
      "a finite error; not run: settings of more work than their solver's time on the scene allowed, each with its "
      "reason in its file. No solver is ranked on a refused scene; see the next table. Not ranked: the scene depends "
      "on a stiffness that "
      "is no parameter of the solver; see the material card.",
      {{"scene", "solver", "to 1 %", "to 0.1 %", "best error in real time", "best error", "failed", "to 1 %, fenced",
        "to 0.1 %, fenced", "to 1 %, GPU", "to 0.1 %, GPU", "ranked"}}};
  const auto always = [](const WorkPoint&) { return true; };
  t.note = with_withheld(t.note, cells_of(diagrams), {"frame_wall_median_s", "truth_error"});
  for (const WorkDiagram& d : diagrams) {
    const std::string refused = d.refused();
    for (const std::string& solver : solvers_of(d)) {
      std::size_t failed = 0, all = 0, able = 0, over_budget = 0;
      for (const WorkPoint& p : d.points)
        if (p.solver == solver) {
          ++all;
          if (p.cell->outcome.status == "over_budget")
            ++over_budget;
          else if (!drawn(p) && !p.cell->withheld.contains("frame_wall_median_s"))
            ++failed;
          if (p.cell->outcome.status != "unsupported" && p.cell->outcome.status != "missing") ++able;
        }
      const auto by_gpu = [&](double most) {
        const auto counts = [&](const WorkPoint& p) { return timed_on_gpu(p) && p.error <= most; };
        return time_text(best(d, solver, counts, &WorkPoint::device_ms_per_s), &WorkPoint::device_ms_per_s);
      };
      const auto fenced = [&](double most) {
        return time_text(best(d, solver, within(most), &WorkPoint::fenced_ms_per_s), &WorkPoint::fenced_ms_per_s);
      };
      const auto flag = d.flagged.find(solver);
      const bool yardstick = solver == "reference";
      t.rows.push_back({d.scene + (refused.empty() ? "" : " (refused)"), solver,
                        time_text(best(d, solver, within(1e-2), &WorkPoint::wall_ms_per_s)),
                        time_text(best(d, solver, within(1e-3), &WorkPoint::wall_ms_per_s)),
                        error_text(d, best(d, solver, in_real_time, &WorkPoint::error)),
                        error_text(d, best(d, solver, always, &WorkPoint::error)),
                        able == 0 ? "unsupported" : failed_text(failed, all, over_budget), fenced(1e-2), fenced(1e-3),
                        by_gpu(1e-2), by_gpu(1e-3),
                        flag != d.flagged.end()         ? "NO: stiffness not a parameter"
                        : able == 0 || !refused.empty() ? "no"
                        : yardstick                     ? "yardstick"
                                                        : "yes"});
    }
  }
  return t;
}

Table truth_table(const std::vector<WorkDiagram>& diagrams) {
  Table t{
      "Truths and their reference solutions",
      "Space: the same mesh's exact solution against the continuum. U_ref: uncertainty of the reference solution (two "
      "integrators, three time steps) of the card's quantity, over its scale; its distance from the truth must be "
      "below it. "
      "Order: observed, 2 declared; – where all time steps agree.",
      {{"scene", "error", "space", "U_ref", "reference − truth", "order BDF2", "order conservative", "ranks"}}};
  const auto order = [](double v) { return std::isfinite(v) ? fmt::format("{:.2f}", v) : std::string("–"); };
  for (const WorkDiagram& d : diagrams) {
    const std::string refused = d.refused();
    t.rows.push_back({d.scene, d.ranking, error_number(d.space_error), error_number(d.uncertainty),
                      error_number(d.truth_distance), order(d.order_bdf2), order(d.order_conservative),
                      refused.empty() ? "yes" : "REFUSED: " + refused});
  }
  return t;
}

std::string work_csv(const std::vector<WorkDiagram>& diagrams) {
  std::string out = csv_row({"scene", "card", "ranking", "space_error", "floor", "refused", "solver", "setting",
                             "status", "gpu", "gpu_is_software", "on_gpu", "wall_ms_per_s", "fenced_ms_per_s",
                             "device_ms_per_s", "error", "on_front", "not_ranked"});
  for (const WorkDiagram& d : diagrams)
    for (const WorkPoint& p : d.points) {
      const json& e = p.cell->header.environment;
      const std::string software = e.is_object() && e.value("gpu_is_software", json()) == json(true) ? "true" : "false";
      out += csv_row({d.scene, d.card, d.ranking, csv_number(d.space_error), csv_number(d.floor()), d.refused(),
                      p.solver, p.setting, p.cell->outcome.status, e.is_object() ? e.value("gpu", "") : "", software,
                      p.on_gpu ? "true" : "false", csv_number(p.wall_ms_per_s), csv_number(p.fenced_ms_per_s),
                      csv_number(p.device_ms_per_s), csv_number(p.error), p.on_front ? "true" : "false",
                      d.flagged.contains(p.solver) ? d.flagged.at(p.solver) : ""});
    }
  return out;
}

json work_json(const std::vector<WorkDiagram>& diagrams) {
  json out = json::array();
  for (const WorkDiagram& d : diagrams) {
    json points = json::array();
    for (const WorkPoint& p : d.points)
      points.push_back({{"solver", p.solver},
                        {"setting", p.setting},
                        {"settings", p.cell->header.settings},
                        {"status", p.cell->outcome.status},
                        {"gpu", p.on_gpu ? gpu_of(*p.cell) : ""},
                        {"wall_ms_per_s", finite_or_null(p.wall_ms_per_s)},
                        {"fenced_ms_per_s", finite_or_null(p.fenced_ms_per_s)},
                        {"device_ms_per_s", finite_or_null(p.device_ms_per_s)},
                        {"error", finite_or_null(p.error)},
                        {"on_front", p.on_front}});
    out.push_back({{"scene", d.scene},
                   {"card", d.card},
                   {"ranking", d.ranking},
                   {"space_error", finite_or_null(d.space_error)},
                   {"reference_uncertainty", finite_or_null(d.uncertainty)},
                   {"reference_truth_distance", finite_or_null(d.truth_distance)},
                   {"reference_order_bdf2", finite_or_null(d.order_bdf2)},
                   {"reference_order_conservative", finite_or_null(d.order_conservative)},
                   {"refused", d.refused()},
                   {"rank_floor", d.rank_floor()},
                   {"not_ranked", d.flagged},
                   {"points", std::move(points)}});
  }
  return out;
}

}  // namespace clothbench
