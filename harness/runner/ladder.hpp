#pragma once
#include <map>
#include <string>

#include "runner/solver_run.hpp"

namespace clothbench {

/// What solvers may spend on their ladders of settings on one scene, climbed from the least work up. Runs that stand
/// on no ladder (RunSpec::work is 0) are never refused.
class LadderBudget {
 public:
  /// Wall time of loads and untimed passes [s] of one solver; 0 = no limit.
  explicit LadderBudget(double limit_s) : limit_s_(limit_s) {}

  /// Why this run is skipped, "" if it is not: a setting of less work timed out; or, were it as much slower than the
  /// one before as it is more work, its solver's budget would not suffice. A solver's first run is never skipped.
  std::string refused(const RunSpec&) const;
  /// What a run took, and how it ended.
  void spent(const RunSpec&, double seconds, const std::string& status);
  /// What a run may take at most [s], if it may take `run_limit_s` (0 = no limit): no more than is left of the
  /// budget, but half of a whole one in any case, since what is left was estimated. 0 = no limit.
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
