#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clothbench/error.hpp"
#include "runner/study_runner.hpp"

namespace clothbench {

/// Plans with plugins run in a process of their own, where everything is timed as usual; this one only watches. If that
/// process crashes, or a plugin's run makes no headway for 15 minutes ($CLOTHBENCH_PLUGIN_LIMIT_S), the run it was at
/// becomes a row `crashed` or `timed_out` and a new process goes on with the rest.

/// True if some run's solver is a plugin and this process is not already such a child.
bool needs_supervision(const RunPlan&);

/// Runs this command, `words` after the program's name, in children until one comes to its end. Its output and its exit
/// code are the command's.
ExitCode supervise(const RunPlan&, const std::filesystem::path& out, bool resume,
                   const std::vector<std::string>& words);

/// The child's side. Where it must write, and whether it goes on with what is there; empty in any other process.
struct Supervised {
  std::filesystem::path out;
  bool resume = false;
};
std::optional<Supervised> supervised();

/// What is being done, for whoever has to tell if this process does not come back. Gone with the object.
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
