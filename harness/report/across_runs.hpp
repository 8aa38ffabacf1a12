#pragma once
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// What no run shows alone, a solver and setting at a time:
///   S22  error of a run with a hitch or jitter over that of the same time in even frames: at most 3
///   S24  the same sheet a thousand times smaller and larger, by powers of two: the same bits
///   S25  stretch against resolution: no bound, iterative solvers get softer
///   S26  the same run again, in another process: the same bits; with another seed: the spread
struct AcrossRuns {
  std::string case_name, solver, setting, figure, text;  ///< figure: what `value` is
  double value = kMissing, bound = kMissing;             ///< bound missing: reported, not judged
  bool judged() const { return bound == bound; }
  bool passed() const { return value <= bound; }
};

/// Of the runs of a stability study. Positions are read from their files. A comparison that lacks a run, or one of
/// whose runs did not end well, is left out, or not kept where its bound is of bits.
std::vector<AcrossRuns> across_runs(const std::vector<RunRecord>& runs);

Table across_table(const std::vector<AcrossRuns>&);
std::string across_csv(const std::vector<AcrossRuns>&);

}  // namespace clothbench
