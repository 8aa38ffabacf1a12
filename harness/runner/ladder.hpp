#pragma once
#include <map>
#include <string>

#include "runner/cell.hpp"

namespace clothbench {

/// What solvers may spend on their ladders of settings on one scene, climbed from the least work up. Cells that stand
/// on no ladder (CellSpec::work is 0) are never refused.
class LadderBudget {
 public:
  /// Wall time of loads and untimed passes [s] of one solver; 0 = no limit.
  explicit LadderBudget(double limit_s) : limit_s_(limit_s) {}

  /// Why this cell is not to be run, "" if it is: a setting of less work timed out; or, were it as much slower than the
  /// one before as it is more work, its solver's budget would not suffice. A solver's first cell always runs.
  std::string refused(const CellSpec&) const;
  /// What a cell took, and how it ended.
  void spent(const CellSpec&, double seconds, const std::string& status);
  /// What a cell may take at most [s], if it may take `cell_limit_s` (0 = no limit): no more than is left of the
  /// budget, but half of a whole one in any case, since what is left was estimated. 0 = no limit.
  double cell_limit_s(const CellSpec&, double cell_limit_s) const;

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
