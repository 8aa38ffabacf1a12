#include "runner/child.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>

#include "clothbench/error.hpp"
#include "runner/cell.hpp"

namespace clothbench {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

std::string ChildEnd::text() const {
  switch (how) {
    case How::Exited:
      return fmt::format("exit status {}", code);
    case How::Signalled:
      return fmt::format("signal {} ({})", code, strsignal(code));
    case How::TimedOut:
      return fmt::format("killed after {:.1f} s", wall_s);
  }
  return "";
}

Child::Child(const std::vector<std::string>& argv, const std::filesystem::path& log) {
  int ends[2];
  // Closed in every other child: a hang-up is then this child's end and nobody else's.
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw Error(argv[0] + ": cannot be started: " + std::strerror(errno), ExitCode::CheckFailed);
  std::vector<char*> words;
  for (const std::string& word : argv) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND, 0644);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  const int failed = posix_spawn(&pid_, words[0], &files, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  close(ends[1]);
  socket_ = ends[0];
  if (failed == 0) return;
  close(socket_);
  throw Error(argv[0] + ": cannot be started: " + std::strerror(failed), ExitCode::CheckFailed);
}

Child::~Child() {
  close(socket_);
  // One that waits for a line sees that there are no more, and cleans up.
  if (pid_ < 0) return;
  int status = 0;
  for (int k = 0; k < 500; ++k) {
    if (waitpid(pid_, &status, WNOHANG) == pid_) return;
    usleep(2000);
  }
  reap(true);
}

/// The exit status of a child that has ended or is ended.
int Child::reap(bool kill_it) {
  int status = 0;
  if (kill_it) kill(pid_, SIGKILL);
  while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  return status;
}

std::optional<ChildEnd> Child::ask(const std::string& line, double limit_s) {
  const auto began = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - began).count(); };
  const std::string text = line + "\n";
  bool gone = send(socket_, text.data(), text.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(text.size());
  while (!gone) {
    pollfd waiting{socket_, POLLIN, 0};
    constexpr int kLook_ms = 50;
    if (poll(&waiting, 1, kLook_ms) > 0) {
      char c = 0;
      const ssize_t got = recv(socket_, &c, 1, 0);
      if (got == 1) return std::nullopt;
      gone = !(got < 0 && errno == EINTR);
    }
    if (interrupt_requested()) {
      reap(true);
      throw Error("interrupted; finished cells are kept (continue with --resume)", ExitCode::Interrupted);
    }
    if (limit_s > 0 && elapsed() > limit_s) {
      reap(true);
      return ChildEnd{ChildEnd::How::TimedOut, 0, elapsed()};
    }
  }
  const int status = reap(false);
  if (WIFSIGNALED(status)) return ChildEnd{ChildEnd::How::Signalled, WTERMSIG(status), elapsed()};
  return ChildEnd{ChildEnd::How::Exited, WEXITSTATUS(status), elapsed()};
}

std::optional<std::string> next_line_from_parent() {
  std::string line;
  for (char c = 0; read(STDIN_FILENO, &c, 1) == 1; line += c)
    if (c == '\n') return line;
  return std::nullopt;
}

void answer_parent() { static_cast<void>(send(STDIN_FILENO, "\n", 1, MSG_NOSIGNAL)); }

std::filesystem::path own_program() {
#ifdef __ANDROID__
  // An app's process is the system's program, not this one.
  throw Error("an app cannot run its cells in processes of their own; use the plain executable");
#else
  return std::filesystem::read_symlink("/proc/self/exe");
#endif
}

}  // namespace clothbench
