#include "runner/again.hpp"

#include <fmt/format.h>
#include <signal.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>

#include "base/files.hpp"
#include "base/json_text.hpp"
#include "base/plugin_environment.hpp"
#include "base/summary_output.hpp"
#include "clothbench/error.hpp"
#include "runner/child.hpp"
#include "runner/interrupt.hpp"
#include "runner/solver_run.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

constexpr char kGuarded[] = "CLOTHBENCH_GUARDED";  // "<number of the call>:<file for its answer>"

}  // namespace

ChildEnd run_again(const std::vector<std::string>& words, const std::string& variable, bool quiet,
                   const std::function<bool()>& is_stuck) {
  std::vector<std::string> argv = {own_program().string()};
  argv.insert(argv.end(), words.begin(), words.end());
  // A group of its own: Ctrl-C comes to it once, from here, since a second one would cut it off.
  ChildProcess child(argv, {.out = quiet ? "/dev/null" : "",
                            .output = SummaryOutput::descriptor(),
                            .own_group = true,
                            .environment = {variable}});
  bool forwarded = false;
  return child.wait([&] {
    if (interrupt_requested() && !forwarded) child.signal(SIGINT);
    forwarded = forwarded || interrupt_requested();
    return is_stuck();
  });
}

void end_with_parent() {
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
}

double plugin_limit_s() {
  constexpr double kUsual = 900;
  const char* given = std::getenv("CLOTHBENCH_PLUGIN_LIMIT_S");
  const double s = given != nullptr ? std::atof(given) : kUsual;
  return s > 0 ? s : kUsual;
}

bool Guard::in_child() { return std::getenv(kGuarded) != nullptr; }

Guard::Guard(const std::vector<std::string>& words) : words_(words) {
  const char* given = std::getenv(kGuarded);
  if (given == nullptr) return;
  const std::string text = given;
  wanted_ = std::atoi(text.c_str());
  file_ = text.substr(text.find(':') + 1);
  end_with_parent();
}

Guard::Answer Guard::run(const SolverEntry& entry, const std::function<nlohmann::json()>& work, bool quiet) {
  const int call = calls_++;
  if (wanted_ >= 0) {
    if (call == wanted_) answer_parent(work);
    return {nullptr, "another call's child"};
  }
  if (!is_external(entry.info) || plugins_in_process()) return {work(), ""};
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
  std::_Exit(0);  // neither exit handlers of a plugin nor the rest of the command
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
  const ChildEnd end = run_again(words_, fmt::format("{}={}:{}", kGuarded, calls_ - 1, file.string()), quiet, too_long);
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
