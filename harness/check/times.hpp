#pragma once
#include <vector>

#include "clothbench/record.hpp"

namespace clothbench {

/// Processes that each side needs for a statement about times. With 5 and 5 the test has a size of 4.8 %.
inline constexpr std::size_t kMinProcesses = 5;
inline constexpr std::size_t kMaxProcesses = 12;  ///< of each side; all C(24, 12) assignments are evaluated

/// Ratio of the frame times B/A, estimated from processes. The unit of replication is the process, since the trials of
/// one process share its memory layout, its clocks and the state of its driver. `ratio`: of the geometric means over
/// the processes. `p`: exact permutation test of the difference of the mean logarithms over all assignments of the
/// processes to the two sides, twice the smaller tail. `low`, `high`: the ratios that this test does not reject at 5 %
/// (equal tails of 2.5 % at most). Source: Good, Permutation, Parametric and Bootstrap Tests of Hypotheses (3rd
/// ed.), 3.2. It assumes that processes are exchangeable if the builds are equally fast, so run those of A and B in
/// turns.
struct TimeRatio {
  double ratio = kMissing, low = kMissing, high = kMissing, p = kMissing;
  std::size_t processes_a = 0, processes_b = 0;
  bool enough() const { return processes_a >= kMinProcesses && processes_b >= kMinProcesses; }
  /// True if no difference is shown: too few processes, or an interval that contains 1.
  bool noise() const { return !(low > 1) && !(high < 1); }
};

/// `a`, `b`: frame time [s] of each process, positive. Throws Error if a side has more than kMaxProcesses.
TimeRatio compare_times(const std::vector<double>& a, const std::vector<double>& b);

/// Frame times [s] of one run in several processes: of each that has trials the median of the trials' means.
std::vector<double> process_times(const std::vector<const RunRecord*>&);

/// Whether the processes of the two sides ran in turns, by the start of their trials: from one side to the other at
/// least as often as in a random order, 2 a b/(a + b) times of a and b processes. Otherwise a drift of the machine is
/// taken for a difference of the builds. True if a start is not known.
bool in_turns(const std::vector<const RunRecord*>& a, const std::vector<const RunRecord*>& b);

}  // namespace clothbench
