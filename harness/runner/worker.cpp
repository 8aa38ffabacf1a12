#include "runner/worker.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "base/child_process.hpp"
#include "clothbench/error.hpp"
#include "runner/interrupt.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The last line that a child wrote after the first `from` bytes, shortened; it usually explains why the child ended.
std::string last_words(const fs::path& log, std::uintmax_t from) {
  std::ifstream in(log);
  in.seekg(static_cast<std::streamoff>(from));
  std::string last;
  for (std::string line; std::getline(in, line);)
    if (!line.empty()) last = line;
  return last.size() > 300 ? last.substr(0, 300) + "…" : last;
}

void tell_parent(const std::string& line) {
  static_cast<void>(send(STDIN_FILENO, (line + "\n").data(), line.size() + 1, MSG_NOSIGNAL));
}

/// The function's answer or error, after lines of progress.
json answer_of(const WorkerFunctions& functions, const json& request) {
  const auto progress = [](const std::string& what, std::size_t done, std::size_t total) {
    tell_parent(fmt::format("{} {} {}", done, total, what));
  };
  try {
    return {{"value", functions.at(request.at("function"))(request.at("request"), progress)}};
  } catch (const Error& e) {
    return {{"error", e.what()}, {"code", static_cast<int>(e.code())}};
  }
}

}  // namespace

std::filesystem::path own_program() {
#ifdef __ANDROID__
  // In an app, the process's executable is the system's, not this program.
  throw Error("the app cannot start child processes, which this study needs; use the plain executable");
#else
  return std::filesystem::read_symlink("/proc/self/exe");
#endif
}

int run_child_main(const WorkerFunctions& functions) {
  // Only the parent handles Ctrl-C. If it ended this process, the current run would be stored as crashed.
  signal(SIGINT, SIG_IGN);
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  std::string line;
  for (char c = 0; read(STDIN_FILENO, &c, 1) == 1;) {
    if (c != '\n') {
      line += c;
      continue;
    }
    // If the parent was killed before prctl, no signal follows, but its end of the socket is closed.
    pollfd parent{STDIN_FILENO, POLLIN, 0};
    if (poll(&parent, 1, 0) > 0 && (parent.revents & POLLHUP) != 0) return 0;
    tell_parent(dump(answer_of(functions, json_from(line))));
    line.clear();
  }
  return 0;
}

double solver_limit_s() {
  constexpr double kUsual = 900;
  const char* given = std::getenv("CLOTHBENCH_SOLVER_LIMIT_S");
  const double s = given != nullptr ? std::atof(given) : kUsual;
  return s > 0 ? s : kUsual;
}

json device_to_json(const DeviceOptions& d) {
  return {{"index", d.index}, {"validate", d.validation}, {"profile", d.profile}};
}

DeviceOptions device_from_json(const json& j) {
  DeviceOptions d;
  j.at("index").get_to(d.index);
  j.at("validate").get_to(d.validation);
  j.at("profile").get_to(d.profile);
  return d;
}

Worker::Worker(fs::path program, fs::path scratch) : program_(std::move(program)), scratch_(std::move(scratch)) {}

std::optional<ChildEnd> Worker::ask(const std::string& line, double limit_s, const char* interrupted,
                                    const std::function<double(const std::string&)>& heard, std::string& answer) {
  using namespace std::chrono_literals;
  auto since = std::chrono::steady_clock::now();
  const auto waited = [&](ChildEnd end) {
    end.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
    return end;
  };
  std::string said;
  bool gone = !child_->write(line + "\n");
  while (!gone) {
    char c = 0;
    const ChildProcess::Heard byte = child_->read(c, 50ms);
    if (byte == ChildProcess::Heard::Byte && c == '\n') {
      if (said.starts_with('{')) {
        answer = std::move(said);
        return std::nullopt;
      }
      if (heard) limit_s = heard(said);
      since = std::chrono::steady_clock::now();
      said.clear();
    } else if (byte == ChildProcess::Heard::Byte) {
      said += c;
      continue;
    }
    gone = byte == ChildProcess::Heard::End;
    if (interrupt_requested()) {
      child_->kill();
      stop_if_interrupted(interrupted);
    }
    if (limit_s > 0 && waited({}).wall_s > limit_s) return waited(child_->kill());
  }
  return waited(child_->wait());
}

WorkerAnswer Worker::call(const std::string& function, const json& request, double limit_s, const char* interrupted,
                          const std::function<double(const std::string&, std::size_t, std::size_t)>& heard) {
  constexpr int kCallsAChild = 100;  // bounds the memory that drivers leak
  const fs::path log = scratch_.empty() ? fs::path() : scratch_ / "output.txt";
  if (calls_ == kCallsAChild) child_.reset();
  if (!child_) {
    if (!scratch_.empty()) fs::create_directories(scratch_);
    const fs::path program = program_.empty() ? own_program() : program_;
    child_ = std::make_unique<ChildProcess>(std::vector<std::string>{program.string(), "run-child"},
                                            ChildSetup{.socket = true, .out = log.string(), .err = log.string()});
    ++children_;
    calls_ = 0;
  }
  std::error_code ignored;
  said_ = calls_ == 0 || log.empty() ? 0 : fs::file_size(log, ignored);
  ++calls_;
  const auto progress = [&](const std::string& line) {
    std::istringstream words(line);
    std::size_t done = 0, total = 0;
    words >> done >> total;
    std::string what;
    std::getline(words >> std::ws, what);
    return heard ? heard(what, done, total) : limit_s;
  };
  std::string text;
  const std::optional<ChildEnd> end =
      ask(dump(json{{"function", function}, {"request", request}}), limit_s, interrupted, progress, text);
  if (end) {
    child_.reset();
    return {nullptr, end, log.empty() ? "" : last_words(log, said_)};
  }
  const json answer = json_from(text);
  if (answer.contains("error"))
    throw Error(answer["error"].get<std::string>(), static_cast<ExitCode>(answer["code"].get<int>()));
  return {answer["value"]};
}

WorkerAnswer guarded(Worker& worker, const std::string& function, const json& request,
                     const std::function<json(const json&)>& work) {
  return solvers_in_process() ? WorkerAnswer{work(request)}
                              : worker.call(function, request, solver_limit_s(), "interrupted");
}

}  // namespace clothbench
