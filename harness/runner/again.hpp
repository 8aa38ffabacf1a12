#pragma once
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/child_process.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// Runs this command again in a child process that a plugin may crash. The child gets the same arguments (`words`),
/// `variable` ("NAME=value") in its environment, and no output if `quiet`. Ctrl-C is passed on to it. `is_stuck` is
/// called about 50 times a second and returns whether to kill it. Throws Error if the child cannot be started.
ChildEnd run_again(const std::vector<std::string>& words, const std::string& variable, bool quiet,
                   const std::function<bool()>& is_stuck);

/// In such a child: ends this process with its parent, even if it hangs in a plugin.
void end_with_parent();

/// Longest time [s] a plugin may run without progress: $CLOTHBENCH_PLUGIN_LIMIT_S, or 900.
double plugin_limit_s();

/// Runs the solver calls of commands other than `run` and `study`. A plugin's call runs in a child, which is this
/// command started again for that one call. So a crash becomes a result, and the results of other solvers are kept.
class Guard {
 public:
  /// `words`: the command's arguments after the program's name; they must outlive the guard.
  explicit Guard(const std::vector<std::string>& words);

  struct Answer {
    nlohmann::json value;
    std::string crash;  ///< how the child ended if it gave no answer; else empty
  };
  /// Calls `work()`, in a child if the solver is a plugin, and throws what it throws. Every run of a command must call
  /// this function with the same work in the same order. A child skips all calls but one and returns a crash for them.
  Answer run(const SolverEntry&, const std::function<nlohmann::json()>& work, bool quiet = true);

  /// Whether a plugin has crashed so far: exit code 1.
  bool crashed() const { return crashed_; }

  /// Whether this process is such a child, which prints no results itself.
  static bool in_child();

 private:
  Answer ask_child(bool quiet);
  [[noreturn]] void answer_parent(const std::function<nlohmann::json()>& work) const;

  const std::vector<std::string>& words_;
  int calls_ = 0;
  int wanted_ = -1;   ///< in a child: the index of its call
  std::string file_;  ///< file for its answer
  bool crashed_ = false;
};

}  // namespace clothbench
