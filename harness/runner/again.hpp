#pragma once
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/child_process.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// This command, run again in a child that a plugin may bring down: the same words after the program's name, with
/// `variable`, "NAME=value", in its environment and without output if `quiet`. Ctrl-C is passed on to it.
/// `stands_still`, asked about 50 times a second, says whether to kill it. Throws Error if it cannot be started.
ChildEnd run_again(const std::vector<std::string>& words, const std::string& variable, bool quiet,
                   const std::function<bool()>& stands_still);

/// In such a child: whoever ends the parent means this process too, which may hang in a plugin.
void end_with_parent();

/// For how long a plugin may make no headway: $CLOTHBENCH_PLUGIN_LIMIT_S, or 900.
double plugin_limit_s();

/// What commands other than `run` and `study` ask of a solver. A plugin's part is done in a child, this command itself
/// started again for that one call, so that a crash is an answer and what others have answered is kept.
class Guard {
 public:
  /// `words` of the command, after the program's name; they outlive the guard.
  explicit Guard(const std::vector<std::string>& words);

  struct Answer {
    nlohmann::json value;
    std::string crash;  ///< how the child ended instead of answering; empty if it did answer
  };
  /// `work()`, in a child if the solver is a plugin. Throws what it throws. Every run of a command must make the same
  /// calls of this function in the same order. In a child all but one are skipped, with a crash as answer.
  Answer run(const SolverEntry&, const std::function<nlohmann::json()>& work, bool quiet = true);

  /// Whether a plugin has crashed so far: exit code 1.
  bool crashed() const { return crashed_; }

  /// Whether this process is such a child, which has nothing to show of its own.
  static bool in_child();

 private:
  Answer ask_child(bool quiet);
  [[noreturn]] void answer_parent(const std::function<nlohmann::json()>& work) const;

  const std::vector<std::string>& words_;
  int calls_ = 0;
  int wanted_ = -1;   ///< in a child: the call that it is there for
  std::string file_;  ///< and where its answer goes
  bool crashed_ = false;
};

}  // namespace clothbench
