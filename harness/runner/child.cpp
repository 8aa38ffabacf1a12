#include "runner/child.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <thread>

#include "clothbench/error.hpp"
#include "runner/cell.hpp"

namespace clothbench {
namespace {

using Clock = std::chrono::steady_clock;

pid_t start(const std::vector<std::string>& argv, const std::filesystem::path& log) {
  std::vector<char*> words;
  for (const std::string& word : argv) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  pid_t pid = 0;
  const int failed = posix_spawn(&pid, words[0], &files, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (failed != 0) throw Error(argv[0] + ": cannot be started: " + std::strerror(failed), ExitCode::CheckFailed);
  return pid;
}

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

ChildEnd run_child(const std::vector<std::string>& argv, double limit_s, const std::filesystem::path& log) {
  const auto began = Clock::now();
  const pid_t pid = start(argv, log);
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - began).count(); };
  int status = 0;
  bool killed = false, interrupted = false;
  while (true) {
    const pid_t done = waitpid(pid, &status, WNOHANG);
    if (done == pid) break;
    if (done < 0 && errno != EINTR) throw Error(argv[0] + ": lost: " + std::strerror(errno), ExitCode::CheckFailed);
    if (!killed && (interrupt_requested() || (limit_s > 0 && elapsed() > limit_s))) {
      interrupted = interrupt_requested();
      kill(pid, SIGKILL);
      killed = true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (interrupted) throw Error("interrupted; finished cells are kept (continue with --resume)", ExitCode::Interrupted);
  ChildEnd end;
  end.wall_s = elapsed();
  end.how = killed ? ChildEnd::How::TimedOut : WIFSIGNALED(status) ? ChildEnd::How::Signalled : ChildEnd::How::Exited;
  end.code = WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status);
  return end;
}

std::filesystem::path own_program() {
#ifdef __ANDROID__
  // An app's process is the system's program, not this one.
  throw Error("an app cannot run its cells in processes of their own; use the plain executable");
#else
  return std::filesystem::read_symlink("/proc/self/exe");
#endif
}

}  // namespace clothbench
