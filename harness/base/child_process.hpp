#pragma once
#include <sys/types.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace clothbench {

/// How a child process ended.
struct ChildEnd {
  enum class How { Exited, Signalled, TimedOut };
  How how = How::Exited;
  int code = 0;  ///< exit status, or number of the signal
  double wall_s = 0;
  /// "signal 11 (Segmentation fault)", "exit status 3", "killed after 5 s"
  std::string text() const;
};

/// What a child process differs in from this one.
struct ChildSetup {
  bool socket = false;             ///< its standard input is a socket, with this process at the other end
  std::string out = {}, err = {};  ///< files that its output goes to, begun anew; empty: to where this process's goes
  bool own_group = false;          ///< Ctrl-C on the terminal does not reach it
  std::vector<std::string> environment = {};  ///< "NAME=value", instead of or beside what this process has
};

/// Another program, running. The one place that starts, watches and ends processes. Not to be shared between threads.
class ChildProcess {
 public:
  /// argv[0]: a path, or a name that is looked for on PATH. Throws Error (CheckFailed) if it cannot be started.
  explicit ChildProcess(const std::vector<std::string>& argv, const ChildSetup& = {});
  /// A program that reads the socket sees its end; one that has not ended a second later is killed.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// False once the program takes no more: an error instead of a signal, since it is a socket and not a pipe.
  bool write(std::string_view bytes);
  enum class Heard { Byte, Nothing, End };
  /// The next byte that the program wrote to the socket, for which it is waited up to `timeout`.
  Heard read(char& byte, std::chrono::milliseconds timeout);
  void close_socket();

  void signal(int number);
  ChildEnd kill();  ///< TimedOut
  ChildEnd wait();
  /// Asked every `look`, `give_up` says whether to kill it.
  ChildEnd wait(const std::function<bool()>& give_up, std::chrono::milliseconds look = std::chrono::milliseconds(20));

 private:
  bool ended(int options);

  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  pid_t pid_ = -1;
  int socket_ = -1;
  std::optional<ChildEnd> end_;
};

}  // namespace clothbench
