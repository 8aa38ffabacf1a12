#pragma once
#include <string>

namespace clothbench {

/// Keeps standard output for a machine-readable summary: while an object of this class lives, all else that this
/// process writes there, code of plugins included, goes to standard error. One at a time.
class SummaryOutput {
 public:
  SummaryOutput();
  ~SummaryOutput();
  SummaryOutput(const SummaryOutput&) = delete;
  SummaryOutput& operator=(const SummaryOutput&) = delete;

  /// Writes to the standard output that this process was started with.
  static void write(const std::string& text);
};

}  // namespace clothbench
