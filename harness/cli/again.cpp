#include "cli/again.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "base/json_text.hpp"
#include "results/store.hpp"
#include "runner/cell.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

constexpr char kGuarded[] = "CLOTHBENCH_GUARDED";  // "<number of the call>:<file for its answer>"

}  // namespace

pid_t start_again(const Console& console, const char* variable, const std::string& value, bool quiet) {
  setenv(variable, value.c_str(), 1);
  std::vector<std::string> words = {own_program().string()};
  words.insert(words.end(), console.words.begin(), console.words.end());
  std::vector<char*> argv;
  for (std::string& w : words) argv.push_back(w.data());
  argv.push_back(nullptr);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  // A group of its own: Ctrl-C comes to it once, from here, since a second one would cut it off.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  if (quiet) posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t pid = -1;
  const int failed = posix_spawn(&pid, argv[0], &files, &attributes, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  unsetenv(variable);
  if (failed != 0) throw Error(words[0] + ": cannot be started: " + std::strerror(failed), ExitCode::CheckFailed);
  return pid;
}

double plugin_limit_s() {
  constexpr double kUsual = 900;
  const char* given = std::getenv("CLOTHBENCH_PLUGIN_LIMIT_S");
  const double s = given != nullptr ? std::atof(given) : kUsual;
  return s > 0 ? s : kUsual;
}

ChildEnd wait_for_end(pid_t pid, const std::function<bool()>& stands_still) {
  using Clock = std::chrono::steady_clock;
  constexpr useconds_t kLook_us = 20000;
  const auto began = Clock::now();
  const auto waited_s = [&] { return std::chrono::duration<double>(Clock::now() - began).count(); };
  bool told = false;
  for (int status = 0;;) {
    const pid_t ended = waitpid(pid, &status, WNOHANG);
    if (ended == pid && WIFSIGNALED(status)) return {ChildEnd::How::Signalled, WTERMSIG(status), waited_s()};
    if (ended == pid) return {ChildEnd::How::Exited, WEXITSTATUS(status), waited_s()};
    if (interrupt_requested() && !told) {
      kill(pid, SIGINT);
      told = true;
    }
    if (stands_still()) {
      kill(pid, SIGKILL);
      waitpid(pid, &status, 0);
      return {ChildEnd::How::TimedOut, 0, waited_s()};
    }
    usleep(kLook_us);
  }
}

bool Guard::in_child() { return std::getenv(kGuarded) != nullptr; }

Guard::Guard(const Console& console) : console_(console) {
  const char* given = std::getenv(kGuarded);
  if (given == nullptr) return;
  const std::string text = given;
  wanted_ = std::atoi(text.c_str());
  file_ = text.substr(text.find(':') + 1);
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // whoever ends the parent means this process too, which may hang in a plugin
#endif
}

Guard::Answer Guard::run(const SolverEntry& entry, const std::function<nlohmann::json()>& work, bool quiet) {
  const int call = calls_++;
  if (wanted_ >= 0) {
    if (call == wanted_) answer_parent(work);
    return {nullptr, "another call's child"};
  }
  if (!is_external(entry.info)) return {work(), ""};
  Answer answer = ask_child(quiet);
  crashed_ = crashed_ || !answer.crash.empty();
  return answer;
}

void Guard::answer_parent(const std::function<nlohmann::json()>& work) const {
  nlohmann::json answer;
  try {
    answer["value"] = work();
  } catch (const Error& e) {
    answer = {{"error", e.what()}, {"code", static_cast<int>(e.code())}};
  }
  std::fflush(stdout);
  write_file_atomically(file_, answer.dump());
  std::_Exit(0);  // neither a plugin's last wishes nor the rest of the command
}

Guard::Answer Guard::ask_child(bool quiet) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("clothbench-guard-{}", getpid());
  fs::create_directories(folder);
  const fs::path file = folder / "answer.json";
  std::error_code ignored;
  fs::remove(file, ignored);
  const auto began = std::chrono::steady_clock::now();
  const auto too_long = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count() > plugin_limit_s();
  };
  const ChildEnd end =
      wait_for_end(start_again(console_, kGuarded, fmt::format("{}:{}", calls_ - 1, file.string()), quiet), too_long);
  const bool answered = end.how == ChildEnd::How::Exited && fs::exists(file);
  const nlohmann::json answer = answered ? nlohmann::json::parse(read_text(file.string())) : nlohmann::json();
  fs::remove_all(folder, ignored);
  if (interrupt_requested()) throw Error("interrupted", ExitCode::Interrupted);
  if (!answered) return {nullptr, end.text()};
  if (answer.contains("error"))
    throw Error(answer["error"].get<std::string>(), static_cast<ExitCode>(answer["code"].get<int>()));
  return {answer["value"], ""};
}

}  // namespace clothbench
