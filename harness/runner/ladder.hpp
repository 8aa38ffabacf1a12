#pragma once
#include <map>
#include <string>

#include "runner/solver_run.hpp"

namespace clothbench {

/// The time budget of solvers on their ladders of settings on one scene, run in ascending order of work. Runs that are
/// not on a ladder (RunSpec::work is 0) are never refused.
class LadderBudget {
 public:
  /// Wall time of loads and untimed passes [s] of one solver; 0 = no limit.
  explicit LadderBudget(double limit_s) : limit_s_(limit_s) {}

  /// Reason why this run is skipped, or "". It is skipped if a setting of less work timed out, or if its expected time
  /// (that of the previous run, scaled by the work) exceeds its solver's remaining budget. A solver's first run is
  /// never skipped.
  std::string refused(const RunSpec&) const;
  /// Records the time of a run and how it ended.
  void spent(const RunSpec&, double seconds, const std::string& status);
  /// Time limit of a run [s], given `run_limit_s` (0 = no limit): at most the remaining budget, but at least half of
  /// the whole budget, since the time was only estimated. 0 = no limit.
  double run_limit_s(const RunSpec&, double run_limit_s) const;

 private:
  struct Climbed {
    double seconds = 0, last_s = 0;
    int last_work = 0;
    int timed_out_work = 0;  ///< 0: none
  };
  double limit_s_;
  std::map<std::string, Climbed> by_solver_;
};

}  // namespace clothbench
