#include "base/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <thread>

#include "clothbench/error.hpp"

extern char** environ;

namespace clothbench {
namespace {

/// Returns 0, or the errno that prevented the start. `input`: descriptor for the child's standard input; -1: inherited.
int spawn(const std::vector<std::string>& argv, const ChildSetup& setup, int input, pid_t& pid) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  const auto open = [&](int descriptor, const std::string& file) {
    posix_spawn_file_actions_addopen(&files, descriptor, file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND, 0644);
  };
  if (input >= 0) posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
  if (!setup.out.empty()) open(STDOUT_FILENO, setup.out);
  if (!setup.err.empty() && setup.err == setup.out)
    posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  else if (!setup.err.empty())
    open(STDERR_FILENO, setup.err);
#ifdef __GLIBC__
  // Otherwise a result file that another thread is writing would stay locked while this child lives.
  posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
#endif
  std::vector<char*> words;
  for (const std::string& word : argv) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const int failed = posix_spawnp(&pid, argv[0].c_str(), &files, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  return failed;
}

}  // namespace

std::string ChildEnd::text() const {
  if (how == How::Exited) return fmt::format("exit status {}", code);
  if (how == How::Signalled) return fmt::format("signal {} ({})", code, strsignal(code));
  return fmt::format("killed after {:.1f} s", wall_s);
}

ChildProcess::ChildProcess(const std::vector<std::string>& argv, const ChildSetup& setup) {
  int ends[2] = {-1, -1};
  // Close-on-exec, so that no other child inherits the socket: a hang-up then means that this child has ended.
  int failed = setup.socket && socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0 ? errno : 0;
  if (failed == 0) failed = spawn(argv, setup, ends[1], pid_);
  socket_ = ends[0];
  if (ends[1] >= 0) close(ends[1]);
  if (failed == 0) return;
  close_socket();
  throw Error(argv[0] + ": cannot be started: " + std::strerror(failed), ExitCode::CheckFailed);
}

ChildProcess::~ChildProcess() {
  using namespace std::chrono_literals;
  close_socket();
  const auto closed = std::chrono::steady_clock::now();
  while (!ended(WNOHANG)) {
    if (std::chrono::steady_clock::now() - closed > 1s) kill();
    std::this_thread::sleep_for(2ms);
  }
}

bool ChildProcess::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

ChildProcess::Heard ChildProcess::read(char& byte, std::chrono::milliseconds timeout) {
  pollfd waiting{socket_, POLLIN, 0};
  if (poll(&waiting, 1, static_cast<int>(timeout.count())) <= 0) return Heard::Nothing;
  const ssize_t got = recv(socket_, &byte, 1, 0);
  if (got == 1) return Heard::Byte;
  return got < 0 && errno == EINTR ? Heard::Nothing : Heard::End;
}

void ChildProcess::close_socket() {
  if (socket_ >= 0) close(socket_);
  socket_ = -1;
}

/// Whether the child has ended; without WNOHANG, waits until it has.
bool ChildProcess::ended(int options) {
  if (end_) return true;
  int status = 0;
  pid_t found = -1;
  while ((found = waitpid(pid_, &status, options)) < 0 && errno == EINTR) {
  }
  if (found == 0) return false;
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  end_ = WIFSIGNALED(status) ? ChildEnd{ChildEnd::How::Signalled, WTERMSIG(status), wall_s}
                             : ChildEnd{ChildEnd::How::Exited, WEXITSTATUS(status), wall_s};
  return true;
}

ChildEnd ChildProcess::kill() {
  if (!end_) ::kill(pid_, SIGKILL);
  ended(0);
  end_->how = ChildEnd::How::TimedOut;
  end_->code = 0;
  return *end_;
}

ChildEnd ChildProcess::wait() {
  ended(0);
  return *end_;
}

}  // namespace clothbench
