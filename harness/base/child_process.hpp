#pragma once
#include <sys/types.h>

#include <chrono>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace clothbench {

/// How a child process ended.
struct ChildEnd {
  enum class How { Exited, Signalled, TimedOut };
  How how = How::Exited;
  int code = 0;  ///< exit status or signal number
  double wall_s = 0;
  /// "signal 11 (Segmentation fault)", "exit status 3", "killed after 5 s"
  std::string text() const;
};

/// Options by which a child process differs from this process.
struct ChildSetup {
  bool socket = false;             ///< standard input is a socket, connected to this process
  std::string out = {}, err = {};  ///< files for stdout and stderr, truncated; empty: inherited
};

/// A running child process. All starting, watching and ending of processes is in this class. Not thread-safe.
class ChildProcess {
 public:
  /// argv[0]: a path, or a name to look up in PATH. Throws Error (CheckFailed) if the program cannot be started.
  explicit ChildProcess(const std::vector<std::string>& argv, const ChildSetup& = {});
  /// Closes the socket, so that a program reading from it can end. Kills the program if it still runs after a second.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Returns false once the program has stopped reading. Uses a socket because writing to a pipe would raise SIGPIPE.
  bool write(std::string_view bytes);
  enum class Heard { Byte, Nothing, End };
  /// Reads the next byte that the program writes to the socket; waits up to `timeout`.
  Heard read(char& byte, std::chrono::milliseconds timeout);
  void close_socket();

  ChildEnd kill();  ///< returns TimedOut
  ChildEnd wait();

 private:
  bool ended(int options);

  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  pid_t pid_ = -1;
  int socket_ = -1;
  std::optional<ChildEnd> end_;
};

/// Environment variable that lists plugins (paths separated by colons); a process finds their solvers by name.
inline constexpr char kPluginsVariable[] = "CLOTHBENCH_PLUGINS";
inline constexpr char kInProcess[] = "CLOTHBENCH_IN_PROCESS";

/// Whether solvers run in this process instead of a child process: $CLOTHBENCH_IN_PROCESS is set, as by --in-process. A
/// debugger then sees them, and a crash ends the program. An app cannot start a child process.
inline bool solvers_in_process() {
#ifdef __ANDROID__
  return true;
#else
  return std::getenv(kInProcess) != nullptr;
#endif
}
inline void run_solvers_in_process() { setenv(kInProcess, "1", 1); }

}  // namespace clothbench
