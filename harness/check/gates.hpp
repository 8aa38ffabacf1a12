#pragma once
#include <string>
#include <vector>

namespace clothbench {

enum class Rule {
  AtMost,  ///< more than the baseline and its slack fails, less than the baseline without it is an improvement
  Kept     ///< a verdict, 1 kept or 0 broken: broken after kept fails, kept after broken is an improvement
};

/// What the absolute slack is a multiple of: 1, the shorter side L of the cloth [m], or its square.
enum class SlackUnit { One, Length, Area };

/// How one summary scalar is held to its baseline.
struct Gate {
  const char* pattern;  ///< name of the scalar; '*' stands for any text
  Rule rule;
  double absolute;  ///< in `unit`
  SlackUnit unit;
  double relative;       ///< share of the baseline's value, added
  bool zero_stays_zero;  ///< a baseline of exactly 0 has no slack
  const char* why;
};

/// Every scalar that is gated; the first pattern that fits a name counts. What depends on the machine (times, rates,
/// bytes on its bus, memory) has no row. A scalar that may grow without a result getting worse must not have one.
const std::vector<Gate>& gates();

/// The row of a scalar, or nullptr if it is not gated.
const Gate* find_gate(const std::string& name);

/// How far a value may lie from `baseline` on either side [unit of the scalar]. `length_m`: shorter side of the cloth.
double slack(const Gate&, double baseline, double length_m);

/// The table as it stands in results/baselines/README.md.
std::string gates_markdown();

}  // namespace clothbench
