#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"
#include "results/conditions.hpp"

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

/// A run that is on both sides, or on one (the other list is empty then).
struct ComparedRun {
  std::string name;
  std::vector<const RunRecord*> a, b;  ///< one per process; results are compared between the first of each side
  std::string marks = {};              ///< kinds of conditions that differ and were allowed: "scene, machine"
  TimeRatio time = {};
  bool in_turns = true;  ///< see in_turns below
  struct Change {
    std::string name;
    double a = kMissing, b = kMissing;
  };
  std::vector<Change> metrics =
      {};  ///< summary values that do not depend on the machine and differ by more than 1e-9 of their size
  std::string outcome = {};  ///< "ok → diverged (F1)", empty if it is the same
  /// Greatest distance between the two motions over the longer side (relation "before" of pairs.hpp); measured only if
  /// a value of the result differs, since positions are read from the files for it.
  double apart = kMissing;
};

/// One element per process: the runs of its folder.
using Processes = std::vector<std::vector<RunRecord>>;

struct Comparison {
  std::vector<ComparedRun> runs;  ///< in the order of A, then those that only B has
  DifferingRuns differing;        ///< conditions that differ and were allowed
};

/// Pairs runs by name. Throws Error if paired runs, or processes of one side, differ in a condition whose kind is not
/// in `allowed` (results/conditions.hpp), or if a process has a run twice. The records must outlive the result.
Comparison compare_runs(const Processes& a, const Processes& b, const std::vector<std::string>& allowed = {});

std::vector<Table> comparison_tables(const Comparison&);
nlohmann::json comparison_json(const Comparison&);

}  // namespace clothbench
