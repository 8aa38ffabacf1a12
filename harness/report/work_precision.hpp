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
  double wall_ms_per_s =
      kMissing;  ///< median wall time, ms per simulated second, frames pipelined where the solver can
  double fenced_ms_per_s = kMissing;  ///< the same from submission to fence, each frame waited for
  double device_ms_per_s = kMissing;  ///< the same of the device's own clock; NaN on a CPU
  double frame_ms = kMissing;         ///< what wall_ms_per_s is of one frame of the scene
  double error = kMissing;            ///< what ranks (the reference case's), as measured
  double energy_gain = kMissing;      ///< over M g L; NaN where the scene does not keep energy
  /// It ended well, with an error and a time.
  bool counts() const { return ok && std::isfinite(error) && std::isfinite(wall_ms_per_s); }
  bool on_front = false;  ///< no other point of its solver is as fast and more accurate
};

/// All runs of one scene with a truth, and what is known of its truth.
struct WorkDiagram {
  std::string scene, reference_case, ranking;  ///< ranking: what the error is, in words
  std::vector<WorkPoint> points;               ///< by solver, then time
  double space_error = kMissing;               ///< this mesh's truth against the continuum
  double uncertainty = kMissing;               ///< U_ref over the quantity's scale
  double truth_distance = kMissing, order_bdf2 = kMissing, order_conservative = kMissing;  ///< of the reference
  StiffnessNeed need = {};                          ///< what its answer depends on
  std::map<std::string, std::string> flagged = {};  ///< solvers shown but not ranked, and why (stiffness_flag)
  double floor() const { return 3 * uncertainty; }  ///< of certainty; NaN if unknown
  /// Errors below it are not distinguished: the greater of floor() and space_error, as far as they are known; 0 if
  /// neither is.
  double rank_floor() const;
  double best_error() const;  ///< of all ranked solvers' points that ended well; NaN if there is none
  /// Why no solver is ranked on it: the reference is missing, or not below a third of the best error. "" if it is.
  std::string refused() const;
};

/// True for a run whose scene states its truth.
bool has_truth(const RunRecord&);

/// Whether it takes no longer than what it simulates.
bool in_real_time(const WorkPoint&);

/// One diagram a scene, in the order of first appearance. `runs` must outlive the answer.
std::vector<WorkDiagram> work_diagrams(const std::vector<RunRecord>& runs, const std::vector<SolverMaterial>& = {});

/// Rows: scenes and solvers; time to 1 % and 0.1 %, best error in real time (a displayed frame of 1/72 s takes at most
/// as long), best error at all, each with its setting; how many runs failed; the first two by the GPU's own clock;
/// whether the solver is ranked.
Table work_table(const std::vector<WorkDiagram>&);

/// The best of the ranked solvers (but the reference) of each scene.
Table winners_table(const std::vector<WorkDiagram>&);

/// Rows: solvers; geometric means over the scenes that rank them of their ranks, never of errors; equal errors at the
/// floor share a rank, and so do all solvers that do not reach it.
Table ranks_table(const std::vector<WorkDiagram>&);

/// Rows: scenes and solvers; the smallest error of all settings whose frame takes at most 0.05 ... 13.9 ms, and which
/// other solver has a smaller one anywhere between.
Table budget_table(const std::vector<WorkDiagram>&);

/// Rows: scenes that keep energy and solvers; the most energy that a setting gains.
Table energy_table(const std::vector<WorkDiagram>&);

/// One row a scene: what the error is, floors, the reference's orders, its distance from the truth, and whether it
/// ranks.
Table truth_table(const std::vector<WorkDiagram>&);

/// One row a point, full precision; what the figures are drawn from.
std::string work_csv(const std::vector<WorkDiagram>&);
nlohmann::json work_json(const std::vector<WorkDiagram>&);

}  // namespace clothbench
