#include "report/work_precision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>

#include "report/grid.hpp"
#include "report/report.hpp"
#include "report/roles.hpp"
#include "report/withheld.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr double kRealTime_ms_per_s = 1000;  // a 72 Hz frame simulates 1/72 s in 1/72 s

std::string reference_case_of(const json& scenario) {
  return scenario.is_object() ? scenario.value(json::json_pointer("/truth/case"), std::string()) : "";
}

/// "swing-strip-32" of the mesh "swing-strip-mesh-32".
std::string grid_scene_of(std::string scene, const json& scenario) {
  constexpr std::string_view kMesh = "-mesh";
  const std::size_t at = scene.find(kMesh);
  if (at == std::string::npos || !scenario.contains(json::json_pointer("/cloth/mesh"))) return "";
  return scene.erase(at, kMesh.size());
}

WorkPoint point_of(const RunRecord& c, const json& scenario) {
  WorkPoint p;
  p.run = &c;
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

void mark_front(std::vector<WorkPoint>& points) {
  for (WorkPoint& p : points) {
    p.on_front = p.counts();
    for (const WorkPoint& q : points)
      if (q.solver == p.solver && q.counts() && q.wall_ms_per_s <= p.wall_ms_per_s && q.error <= p.error &&
          (q.wall_ms_per_s < p.wall_ms_per_s || q.error < p.error))
        p.on_front = false;
  }
}

const WorkPoint* best(const WorkDiagram& d, const std::string& solver,
                      const std::function<bool(const WorkPoint&)>& when, double WorkPoint::*by) {
  const WorkPoint* out = nullptr;
  for (const WorkPoint& p : d.points)
    if (p.solver == solver && p.counts() && when(p) && (out == nullptr || p.*by < out->*by)) out = &p;
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

std::string time_text(const WorkPoint* p, double WorkPoint::*clock) {
  return p == nullptr ? "–" : fmt::format("{:.3g} ({})", p->*clock, short_setting(*p));
}

/// Errors are not distinguished below the floor.
std::string error_text(const WorkDiagram& d, const WorkPoint* p) {
  if (p == nullptr) return "–";
  const bool below = p->error < d.rank_floor();
  return fmt::format("{}{:.2g} ({})", below ? "≤ " : "", below ? d.rank_floor() : p->error, short_setting(*p));
}

/// Settings of a solver on a scene: those without a result, those whose time was used up, all, all that take part, and
/// the ranked of these.
struct Counted {
  std::size_t failed = 0, all = 0, able = 0, over_budget = 0, ranked = 0;
  explicit Counted(const SolverOfScene& s) {
    for (const WorkPoint& p : s.diagram->points) {
      if (p.solver != s.solver) continue;
      const std::string& status = p.run->outcome.status;
      ++all;
      if (status == "over_budget")
        ++over_budget;
      else if (!p.counts() && !p.run->withheld.contains("frame_wall_median_s"))
        ++failed;
      if (p.took_part()) ++able;
      if (p.took_part() && p.not_ranked.empty()) ++ranked;
    }
  }
};

std::string failed_text(const SolverOfScene& s) {
  const Counted n(s);
  if (n.able == 0) return "unsupported";
  return fmt::format("{} of {}", n.failed, n.all) +
         (n.over_budget > 0 ? fmt::format(", {} not run", n.over_budget) : "");
}

std::string ranked_text(const SolverOfScene& s) {
  if (s.diagram->flagged.contains(s.solver)) return "NO: stiffness is not a parameter";
  const Counted n(s);
  if (n.able == 0 || !s.diagram->refused().empty()) return "no";
  if (n.ranked < n.able) return fmt::format("at {} of {} settings", n.ranked, n.able);
  return is_baseline(s.solver) ? "baseline" : "yes";
}

/// A point with its diagram, for CSV.
struct WorkRow : WorkPoint {
  const WorkDiagram* diagram = nullptr;
};

std::vector<WorkRow> work_rows(const std::vector<WorkDiagram>& diagrams) {
  std::vector<WorkRow> out;
  for (const WorkDiagram& d : diagrams)
    for (const WorkPoint& p : d.points) out.push_back({p, &d});
  return out;
}

/// Columns of diagrams and of points common to CSV and JSON. R: WorkDiagram or WorkRow; WorkPoint or WorkRow.
template <class R, class Of>
Columns<R> diagram_columns(Of of) {
  return {{"scene", In::Both, [of](auto& r) { return of(r).scene; }},
          {"case", In::Both, [of](auto& r) { return of(r).reference_case; }},
          {"ranking", In::Both, [of](auto& r) { return of(r).ranking; }},
          {"space_error", In::Both, [of](auto& r) { return of(r).space_error; }},
          {"floor", In::Csv, [of](auto& r) { return of(r).floor(); }},
          {"refused", In::Both, [of](auto& r) { return of(r).refused(); }}};
}

template <class R>
Columns<R> run_columns() {
  return {{"solver", In::Both, &R::solver}, {"setting", In::Both, &R::setting}, {"status", In::Both, status_of}};
}

template <class R>
Columns<R> result_columns() {
  return {{"wall_ms_per_s", In::Both, &R::wall_ms_per_s},
          {"fenced_ms_per_s", In::Both, &R::fenced_ms_per_s},
          {"device_ms_per_s", In::Both, &R::device_ms_per_s},
          {"error", In::Both, &R::error},
          {"on_front", In::Both, &R::on_front}};
}

}  // namespace

bool in_real_time(const WorkPoint& p) { return p.wall_ms_per_s <= kRealTime_ms_per_s; }

double WorkDiagram::best_error() const {
  double least = kMissing;
  for (const WorkPoint& p : points)
    if (p.ranks() && !is_baseline(p.solver) && !(least <= p.error)) least = p.error;
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
  if (!std::isfinite(best)) return "no solver ranked on it has an error";
  const double least = std::max(best, std::isfinite(space_error) ? space_error : 0.0);
  if (!(floor() < least)) return fmt::format("3 U_ref {:.1e} is not below the best error {:.1e}", floor(), least);
  return "";
}

bool has_truth(const RunRecord& c) { return !reference_case_of(scenario_of(c)).empty(); }

std::vector<WorkDiagram> work_diagrams(const std::vector<RunRecord>& runs,
                                       const std::vector<SolverMaterial>& materials) {
  std::vector<WorkDiagram> out;
  for (const RunRecord& c : runs) {
    const json scenario = scenario_of(c);
    const std::string known = reference_case_of(scenario);
    if (known.empty()) continue;
    auto at = std::find_if(out.begin(), out.end(), [&](const WorkDiagram& d) { return d.scene == c.header.scene; });
    if (at == out.end()) {
      out.push_back({c.header.scene, known, truth::tolerance_of(known).ranking, {}});
      at = out.end() - 1;
      at->grid_scene = grid_scene_of(c.header.scene, scenario);
    }
    at->points.push_back(point_of(c, scenario));
    at->points.back().not_ranked = stiffness_flag(materials, c);
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
    for (const WorkPoint& p : d.points)
      if (!p.not_ranked.empty()) d.flagged.insert({p.solver, p.not_ranked});
    for (const WorkPoint& p : d.points)
      if (p.not_ranked.empty() && p.took_part()) d.flagged.erase(p.solver);
    std::stable_sort(d.points.begin(), d.points.end(), [](const WorkPoint& a, const WorkPoint& b) {
      if (a.solver != b.solver) return a.solver < b.solver;
      return a.wall_ms_per_s < b.wall_ms_per_s;
    });
  }
  return out;
}

std::vector<SolverOfScene> solvers_of(const std::vector<WorkDiagram>& diagrams) {
  std::vector<SolverOfScene> out;
  for (const WorkDiagram& d : diagrams)
    for (std::string& solver : distinct(d.points, &WorkPoint::solver)) out.push_back({&d, d.scene, std::move(solver)});
  return out;
}

Table work_table(const std::vector<WorkDiagram>& diagrams) {
  // Least time to an error of at most `most`, by a clock.
  const auto to = [](double most, double WorkPoint::*clock) {
    return [=](const SolverOfScene& s) {
      const auto counts = [&](const WorkPoint& p) { return std::isfinite(p.*clock) && p.error <= most; };
      return time_text(best(*s.diagram, s.solver, counts, clock), clock);
    };
  };
  const auto least = [](const auto& when) {
    return [=](const SolverOfScene& s) {
      return error_text(*s.diagram, best(*s.diagram, s.solver, when, &WorkPoint::error));
    };
  };
  return Columns<SolverOfScene>{
      {"", "scene", [](auto& s) { return s.scene + (s.diagram->refused().empty() ? "" : " (refused)"); }},
      {"", "solver", &SolverOfScene::solver},
      {"", "to 1 %", to(1e-2, &WorkPoint::wall_ms_per_s)},
      {"", "to 0.1 %", to(1e-3, &WorkPoint::wall_ms_per_s)},
      {"", "best error in real time", least(in_real_time)},
      {"", "best error", least([](const WorkPoint&) { return true; })},
      {"", "failed", failed_text},
      {"", "to 1 %, fenced", to(1e-2, &WorkPoint::fenced_ms_per_s)},
      {"", "to 0.1 %, fenced", to(1e-3, &WorkPoint::fenced_ms_per_s)},
      {"", "to 1 %, GPU", to(1e-2, &WorkPoint::device_ms_per_s)},
      {"", "to 0.1 %, GPU", to(1e-3, &WorkPoint::device_ms_per_s)},
      {"", "ranked", ranked_text}}
      .table({"Error against run time",
              with_withheld(
                  "Times: ms of wall time per simulated second, with pipelined frames (two in flight) where the solver "
                  "can; in brackets substeps × iterations. Fenced: each frame from submission to fence; the next "
                  "starts after it. GPU: by the device's own clock. Errors: against the exact solution of the same "
                  "grid; of triangle meshes, against the continuum's. In real time: a frame of 1/72 s takes at most "
                  "1/72 s. ≤: at the floor below which solvers are "
                  "not distinguished, which is three times the reference's uncertainty or the error of the mesh. "
                  "Failed: runs without a finite error. Not run: settings that need more work than the solver's time "
                  "on the scene allowed; each result file has the reason. A refused scene ranks no solver; the next "
                  "table has the reason. Not ranked: the scene depends on a stiffness that is not a parameter of the "
                  "solver at this setting; see the effective moduli.",
                  runs_of(work_rows(diagrams), &WorkRow::run), {"frame_wall_median_s", "truth_error"}),
              {}},
             solvers_of(diagrams));
}

Table truth_table(const std::vector<WorkDiagram>& diagrams) {
  const NumberFormat error = in_form("{:.1e}"), order = in_form("{:.2f}");
  return Columns<WorkDiagram>{
      {"", "scene", &WorkDiagram::scene},
      {"", "error", &WorkDiagram::ranking},
      {"", "space", &WorkDiagram::space_error, error},
      {"", "U_ref", &WorkDiagram::uncertainty, error},
      {"", "reference − exact", &WorkDiagram::truth_distance, error},
      {"", "order BDF2", &WorkDiagram::order_bdf2, order},
      {"", "order conservative", &WorkDiagram::order_conservative, order},
      {"", "ranks", [](auto& d) { return d.refused().empty() ? "yes" : "REFUSED: " + d.refused(); }}}
      .table({"Reference cases and their reference solutions",
              "Space: distance of the same grid's exact solution, or of the same triangle mesh's reference solution, "
              "from the continuum's. U_ref: uncertainty of the reference solution (two integrators, three time steps) "
              "in the reference case's quantity, over its scale. On a grid, the distance of the reference solution "
              "from the exact one must be below U_ref; on a mesh it is an error of the mesh. Order: observed; 2 is "
              "declared. –: all time steps agree.",
              {}},
             diagrams);
}

std::string work_csv(const std::vector<WorkDiagram>& diagrams) {
  return diagram_columns<WorkRow>([](const WorkRow& r) -> auto& { return *r.diagram; })
      .add(run_columns<WorkRow>())
      .add({{"gpu", In::Both, [](auto& r) { return environment_of(*r.run, "gpu"); }},
            {"gpu_is_software", In::Both,
             [](auto& r) { return environment_of(*r.run, "gpu_is_software") == json(true); }},
            {"on_gpu", In::Both, &WorkRow::on_gpu}})
      .add(result_columns<WorkRow>())
      .add({{"not_ranked", In::Both, &WorkRow::not_ranked}})
      .csv(work_rows(diagrams));
}

json work_json(const std::vector<WorkDiagram>& diagrams) {
  const Columns<WorkPoint> points =
      run_columns<WorkPoint>()
          .add({{"settings", In::Both, [](auto& p) { return p.run->header.settings; }},
                {"gpu", In::Both, [](auto& p) { return p.on_gpu ? gpu_of(*p.run) : ""; }}})
          .add(result_columns<WorkPoint>())
          .add({{"not_ranked", In::Json,
                 [](auto& p) { return p.not_ranked.empty() ? absent() : Value(p.not_ranked); }}});
  return diagram_columns<WorkDiagram>([](const WorkDiagram& d) -> auto& { return d; })
      .add({{"reference_uncertainty", In::Both, &WorkDiagram::uncertainty},
            {"reference_truth_distance", In::Both, &WorkDiagram::truth_distance},
            {"reference_order_bdf2", In::Both, &WorkDiagram::order_bdf2},
            {"reference_order_conservative", In::Both, &WorkDiagram::order_conservative},
            {"rank_floor", In::Both, &WorkDiagram::rank_floor},
            {"not_ranked", In::Both, &WorkDiagram::flagged},
            {"grid_scene", In::Json, [](auto& d) { return d.grid_scene.empty() ? absent() : Value(d.grid_scene); }},
            {"points", In::Both, [&](auto& d) { return points.json(d.points); }}})
      .json(diagrams);
}

}  // namespace clothbench
