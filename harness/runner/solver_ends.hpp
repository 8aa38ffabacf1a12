#pragma once
#include <map>
#include <string>
#include <vector>

#include "clothbench/record.hpp"

namespace clothbench {

/// The rule of exit codes for every command that runs solvers: 1 if a solver finished none of its runs, whether they
/// crashed, hung, diverged, lost the device or could not be made. Runs that the solver does not support, or that were
/// left out for time, do not count; a run that ends as its scene expects does.
class SolverEnds {
 public:
  void add(const std::string& solver, const Outcome&);
  /// One sentence per solver that finished none of its runs.
  std::vector<std::string> faults() const;

 private:
  struct Ends {
    int finished = 0, failed = 0;
    std::string last;  ///< how the last one failed
  };
  std::map<std::string, Ends> ends_;
};

}  // namespace clothbench
