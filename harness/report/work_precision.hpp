#pragma once
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"
#include "report/material.hpp"

namespace clothbench {

/// One run in a work-precision diagram.
struct WorkPoint {
  const RunRecord* run = nullptr;
  std::string solver, setting;
  bool on_gpu = false, ok = false;
  double wall_ms_per_s = kMissing;  ///< median wall time, ms per simulated second, pipelined if the solver supports it
  double fenced_ms_per_s = kMissing;  ///< the same, from submission to fence, waiting for each frame
  double device_ms_per_s = kMissing;  ///< the same, by the device's clock; NaN on a CPU
  double frame_ms = kMissing;         ///< wall_ms_per_s for one frame of the scene [ms]
  double error = kMissing;            ///< the measured error that ranks (as the reference case defines it)
  double energy_gain = kMissing;      ///< over M g L; NaN if the scene does not conserve energy
  std::string not_ranked = {};        ///< why this run is shown but not ranked (stiffness_flag); "" if it is ranked
  /// The run ended well and has an error and a time.
  bool counts() const { return ok && std::isfinite(error) && std::isfinite(wall_ms_per_s); }
  /// The solver took part in the scene.
  bool took_part() const { return run->outcome.status != "unsupported" && run->outcome.status != "missing"; }
  bool ranks() const { return counts() && not_ranked.empty(); }
  bool on_front = false;  ///< Pareto front: no point of its solver is better in time or error and as good in the other
};

/// All runs of one scene that has a truth, and the errors of the truth itself.
struct WorkDiagram {
  std::string scene, reference_case, ranking;  ///< ranking: definition of the error, as text
  std::vector<WorkPoint> points;               ///< by solver, then time
  double space_error = kMissing;               ///< of this mesh's truth against the continuum
  double uncertainty = kMissing;               ///< U_ref over the quantity's scale
  double truth_distance = kMissing, order_bdf2 = kMissing, order_conservative = kMissing;  ///< of the reference
  StiffnessNeed need = {};                          ///< stiffnesses that the exact solution depends on
  std::map<std::string, std::string> flagged = {};  ///< solvers without a ranked setting, and why
  std::string grid_scene = {};  ///< of a triangle mesh: name of the same scene as a grid; "" for a grid
  double floor() const { return 3 * uncertainty; }  ///< uncertainty floor, 3 U_ref; NaN if unknown
  /// Errors below it are not distinguished: the greater of floor() and space_error, of those known; 0 if neither is.
  double rank_floor() const;
  double best_error() const;  ///< of the points of all ranked solvers that ended well; NaN if none did
  /// Why no solver is ranked on it: there is no reference, or 3 U_ref is not below the best error. Else "".
  std::string refused() const;
};

/// A row of tables: a solver with points in a diagram.
struct SolverOfScene {
  const WorkDiagram* diagram;
  std::string scene, solver;
};
/// All of them, by diagram and in the order of its points. `diagrams` must outlive the result.
std::vector<SolverOfScene> solvers_of(const std::vector<WorkDiagram>& diagrams);

/// True for a run whose scene states its truth.
bool has_truth(const RunRecord&);

/// Whether computing takes at most as long as the simulated time.
bool in_real_time(const WorkPoint&);

/// One diagram a scene, in the order of first appearance. `runs` must outlive the result.
std::vector<WorkDiagram> work_diagrams(const std::vector<RunRecord>& runs, const std::vector<SolverMaterial>& = {});

/// Rows: scenes and solvers. Columns: time to an error of 1 % and of 0.1 %, best error in real time (at most 1/72 s for
/// a displayed frame of 1/72 s), best error without a limit, each with its setting; number of failed runs; the first
/// two by the GPU's clock; whether the solver is ranked.
Table work_table(const std::vector<WorkDiagram>&);

/// The best ranked solver of each scene, the reference excepted.
Table winners_table(const std::vector<WorkDiagram>&);

/// Rows: solvers; columns: geometric means of their ranks (never of errors) over the scenes that rank them. Equal
/// errors at the floor share a rank, and so do all solvers that miss the criterion.
Table ranks_table(const std::vector<WorkDiagram>&);

/// Rows: scenes and solvers; columns: smallest error of all settings within budgets of 0.05 ... 13.9 ms a frame, and
/// which other solver has a smaller error at any budget between.
Table budget_table(const std::vector<WorkDiagram>&);

/// Rows: solvers on scenes that conserve energy; column: greatest energy gain of any setting.
Table energy_table(const std::vector<WorkDiagram>&);

/// One row a scene: definition of the error, floors, orders of the reference, its distance from the truth, and whether
/// the scene ranks solvers.
Table truth_table(const std::vector<WorkDiagram>&);

/// One row a point, full precision; the data of the figures.
std::string work_csv(const std::vector<WorkDiagram>&);
nlohmann::json work_json(const std::vector<WorkDiagram>&);

}  // namespace clothbench
