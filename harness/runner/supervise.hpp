#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clothbench/error.hpp"
#include "runner/study_runner.hpp"

namespace clothbench {

/// Plans with plugins run in a child process, where everything is timed as usual; this process only monitors it. If the
/// child crashes, or a plugin's run makes no progress for 15 minutes ($CLOTHBENCH_PLUGIN_LIMIT_S), the current run is
/// recorded as `crashed` or `timed_out` and a new child continues with the rest.

/// True if some run's solver is a plugin and this process is not already such a child.
bool needs_supervision(const RunPlan&);

/// Runs this command, with the arguments `words`, in children until one finishes. Its output and exit code are the
/// command's.
ExitCode supervise(const RunPlan&, const std::filesystem::path& out, bool resume,
                   const std::vector<std::string>& words);

/// The child's side: its output folder, and whether it resumes; empty in any other process.
struct Supervised {
  std::filesystem::path out;
  bool resume = false;
};
std::optional<Supervised> supervised();

/// A note of the current work, which the parent reads if this process crashes. Removed with the object.
class RunningNote {
 public:
  explicit RunningNote(const std::optional<Supervised>&);
  ~RunningNote();
  RunningNote(const RunningNote&) = delete;
  RunningNote& operator=(const RunningNote&) = delete;
  void write(const std::string& what) const;

 private:
  std::filesystem::path file_;  ///< empty: not supervised
};

}  // namespace clothbench
