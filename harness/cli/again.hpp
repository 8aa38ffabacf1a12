#pragma once
#include <sys/types.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/command.hpp"
#include "runner/child.hpp"

namespace clothbench {

/// This command, started again as a child that a plugin may bring down: the same words, with `variable` = `value` in
/// its environment and without output if `quiet`. Throws Error if it cannot be started.
pid_t start_again(const Console&, const char* variable, const std::string& value, bool quiet);

/// For how long a plugin may make no headway: $CLOTHBENCH_PLUGIN_LIMIT_S, or 900.
double plugin_limit_s();

/// Waits for the child's end and passes Ctrl-C on to it. `stands_still`, asked about 50 times a second, says whether to
/// kill it.
ChildEnd wait_for_end(pid_t, const std::function<bool()>& stands_still);

/// What commands other than `run` and `study` ask of a solver. A plugin's part is done in a child, this command itself
/// started again for that one call, so that a crash is an answer and what others have answered is kept.
class Guard {
 public:
  explicit Guard(const Console&);

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

  const Console& console_;
  int calls_ = 0;
  int wanted_ = -1;   ///< in a child: the call that it is there for
  std::string file_;  ///< and where its answer goes
  bool crashed_ = false;
};

}  // namespace clothbench
