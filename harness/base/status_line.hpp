#pragma once
#include <cstddef>
#include <string>

namespace clothbench {

/// A line on the terminal that is overwritten in place and removed at the end; prints nothing into a pipe.
class StatusLine {
 public:
  explicit StatusLine(bool enabled);
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;
  /// `total` 0: unknown, so neither counts nor remaining time are shown.
  void show(const std::string& what, std::size_t done = 0, std::size_t total = 0);

 private:
  bool enabled_;
  double start_s_;
  std::size_t width_ = 0;
};

/// Reserves standard output for a machine-readable summary. While an object of this class exists (at most one), all
/// other output of this process, its plugins included, goes to standard error.
class SummaryOutput {
 public:
  SummaryOutput();
  ~SummaryOutput();
  SummaryOutput(const SummaryOutput&) = delete;
  SummaryOutput& operator=(const SummaryOutput&) = delete;

  /// Writes to the process's original standard output.
  static void write(const std::string& text);
};

}  // namespace clothbench
