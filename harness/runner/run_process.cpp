#include "runner/run_process.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <sys/socket.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <mutex>
#include <sstream>

#include "base/json_text.hpp"
#include "base/plugin_environment.hpp"
#include "clothbench/error.hpp"
#include "metrics/registry.hpp"
#include "results/part_file.hpp"
#include "results/store.hpp"
#include "runner/interrupt.hpp"
#include "runner/solver_run.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Scene scene_of(const RunRequest& r) {
  Scene scene = scene_from_json(r.scenario, r.source, r.set);
  scene.name = r.name;
  return scene;
}

/// Calls `with(key, member)` for each member of a request but its folder. Request: RunRequest, const or not.
template <class Request, class With>
void each_member(Request& r, With with) {
  with("scenario", r.scenario);
  with("source", r.source);
  with("set", r.set);
  with("name", r.name);
  with("solver", r.solver);
  with("setting", r.setting);
  with("settings", r.settings);
  with("device", r.rules.device.index);
  with("validate", r.rules.device.validation);
  with("profile", r.rules.device.profile);
  with("protocol", r.rules.protocol);
  with("limit_s", r.rules.limit_s);
}

/// The last line that a child wrote past the first `from` bytes, shortened: mostly why it ended.
std::string last_words(const fs::path& log, std::uintmax_t from) {
  std::ifstream in(log);
  in.seekg(static_cast<std::streamoff>(from));
  std::string last;
  for (std::string line; std::getline(in, line);)
    if (!line.empty()) last = line;
  return last.size() > 300 ? last.substr(0, 300) + "…" : last;
}

/// The file of a run whose process could not write it.
void write_failure(const RunRequest& r, const RunRecord& answer) {
  static std::mutex mutex;  // the HDF5 library is not for several threads
  const std::lock_guard lock(mutex);
  const Scene scene = scene_of(r);
  const RunHeader h = header_of(scene, r.solver, r.setting, r.settings, r.rules.protocol);
  if (!run_finished(r.rules.out, run_name(h))) write_failed_run(r.rules.out, h, answer.outcome, answer.summary);
}

/// What the function answers or throws.
json answer_of(const WorkerFunctions& functions, const json& request) {
  try {
    return {{"value", functions.at(request.at("function"))(
                          request.at("request"), [](const std::string& what, std::size_t done, std::size_t total) {
                            tell_parent(fmt::format("{} {} {}", done, total, what));
                          })}};
  } catch (const Error& e) {
    return {{"error", e.what()}, {"code", static_cast<int>(e.code())}};
  }
}

void send_parent(const std::string& text) {
  static_cast<void>(send(STDIN_FILENO, text.data(), text.size(), MSG_NOSIGNAL));
}

}  // namespace

Child::Child(const std::vector<std::string>& argv, const std::filesystem::path& log)
    : process_(argv, {.socket = true, .out = log, .err = log}) {}

std::optional<ChildEnd> Child::ask(const std::string& line, double limit_s, const char* interrupted,
                                   const std::function<double(const std::string&)>& heard) {
  using namespace std::chrono_literals;
  auto since = std::chrono::steady_clock::now();
  const auto waited = [&](ChildEnd end) {
    end.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
    return end;
  };
  std::string said;
  bool gone = !process_.write(line + "\n");
  while (!gone) {
    char c = 0;
    const ChildProcess::Heard byte = process_.read(c, 50ms);
    if (byte == ChildProcess::Heard::Byte && c == '\n') {
      if (said.empty()) return std::nullopt;
      if (heard) limit_s = heard(said);
      since = std::chrono::steady_clock::now();
      said.clear();
    } else if (byte == ChildProcess::Heard::Byte) {
      said += c;
      continue;
    }
    gone = byte == ChildProcess::Heard::End;
    if (interrupt_requested()) {
      process_.kill();
      stop_if_interrupted(interrupted);
    }
    if (limit_s > 0 && waited({}).wall_s > limit_s) return waited(process_.kill());
  }
  return waited(process_.wait());
}

void serve_parent(const std::function<void(const std::string&)>& answer) {
  // Ctrl-C is the parent's to act on; here it would make a row of a run that is to be repeated.
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
    answer(line);
    send_parent("\n");
    line.clear();
  }
}

void tell_parent(const std::string& line) { send_parent(line + "\n"); }

std::filesystem::path own_program() {
#ifdef __ANDROID__
  // An app's process is the system's program, not this one.
  throw Error("the app cannot start child processes, which this study needs; use the plain executable");
#else
  return std::filesystem::read_symlink("/proc/self/exe");
#endif
}

json to_json(const RunRequest& r) {
  json j = {{"out", r.rules.out.string()}};
  each_member(r, [&](const char* key, const auto& value) { j[key] = value; });
  return j;
}

RunRequest request_from_json(const json& j) {
  RunRequest r;
  each_member(r, [&](const char* key, auto& value) { j.at(key).get_to(value); });
  r.rules.out = j.at("out").get<std::string>();
  return r;
}

json answer_to_json(const RunRecord& c) { return outcome_to_json(c.outcome, c.summary); }

RunRecord answer_from_json(const json& j) {
  RunRecord c;
  outcome_from_json(j, c);
  return c;
}

void write_failed_run(const fs::path& out, const RunHeader& header, const Outcome& outcome,
                      const std::map<std::string, double>& summary) {
  std::error_code ignored;
  fs::remove(out / (run_name(header) + ".part"), ignored);
  RunWriter(out, header).finish(outcome, summary);
}

RunRecord run_request(const RunRequest& r, const SolverLookup& lookup) {
  try {
    const Scene scene = scene_of(r);
    const SolverEntry& entry = lookup(r.solver);
    return whole_run({&scene, &entry, entry.make ? complete_settings(entry.info, r.settings) : r.settings, r.setting},
                     r.rules);
  } catch (const std::exception& e) {  // what a solver cannot load is a row of the table, whatever it throws
    RunRecord failed;
    failed.outcome = {"error", "F3", -1, e.what()};
    return failed;
  }
}

int run_child_main(const fs::path& folder, const SolverLookup& lookup, const WorkerFunctions& functions) {
  serve_parent([&](const std::string& number) {
    const fs::path file = folder / ("request-" + number + ".json");
    const json request = parse_json(read_text(file), file.string());
    const json answer = request.contains("function") ? answer_of(functions, request)
                                                     : answer_to_json(run_request(request_from_json(request), lookup));
    write_file_atomically(folder / ("answer-" + number + ".json"), answer.dump() + "\n");
  });
  return 0;
}

WorkerAnswer call_worker(const std::string& function, const json& request, double limit_s, const char* interrupted,
                         const std::function<double(const std::string&, std::size_t, std::size_t)>& heard) {
  struct Folder {
    fs::path path = fs::temp_directory_path() / fmt::format("clothbench-call-{}", getpid());
    Folder() { fs::create_directories(path); }
    ~Folder() {
      std::error_code ignored;
      fs::remove_all(path, ignored);
    }
  };
  const Folder folder;
  write_file_atomically(folder.path / "request-1.json",
                        json{{"function", function}, {"request", request}}.dump() + "\n");
  Child child({own_program().string(), "run-child", folder.path.string()}, "");
  std::optional<ChildEnd> end = child.ask("1", limit_s, interrupted, [&](const std::string& line) {
    std::istringstream words(line);
    std::size_t done = 0, total = 0;
    words >> done >> total;
    std::string what;
    std::getline(words >> std::ws, what);
    return heard ? heard(what, done, total) : limit_s;
  });
  if (end) return {nullptr, end};
  const fs::path file = folder.path / "answer-1.json";
  const json answer = parse_json(read_text(file), file.string());
  if (answer.contains("error"))
    throw Error(answer["error"].get<std::string>(), static_cast<ExitCode>(answer["code"].get<int>()));
  return {answer["value"]};
}

WorkerAnswer guarded(const SolverEntry& entry, const std::string& function, const json& request,
                     const std::function<json(const json&)>& work) {
  if (!is_external(entry.info) || plugins_in_process()) return {work(request)};
  return call_worker(function, request, plugin_limit_s(), "interrupted");
}

double plugin_limit_s() {
  constexpr double kUsual = 900;
  const char* given = std::getenv("CLOTHBENCH_PLUGIN_LIMIT_S");
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

RunRequest request_of(const RunSpec& spec, RunRules rules) {
  RunRequest r;
  r.scenario = json::parse(spec.scene->json);
  r.source = spec.scene->source;
  r.name = spec.scene->name;
  r.solver = spec.entry->info.name;
  r.setting = spec.setting;
  r.settings = spec.settings;
  r.rules = std::move(rules);
  return r;
}

RunWorker::RunWorker(fs::path program, fs::path scratch) : program_(std::move(program)), scratch_(std::move(scratch)) {
  fs::create_directories(scratch_);
}

RunWorker::~RunWorker() = default;

/// The child's answer is in its file, or this is how it ended.
std::optional<ChildEnd> RunWorker::ask(const RunRequest& r) {
  constexpr int kRunsAChild = 100;  // what drivers leak is theirs to keep for so long
  const fs::path log = scratch_ / "output.txt";
  if (runs_ == kRunsAChild) child_.reset();
  if (!child_) {
    child_ = std::make_unique<Child>(std::vector<std::string>{program_.string(), "run-child", scratch_.string()}, log);
    ++children_;
    runs_ = 0;
  }
  std::error_code ignored;
  said_ = runs_ == 0 ? 0 : fs::file_size(log, ignored);
  ++number_;
  ++runs_;
  write_file_atomically(scratch_ / fmt::format("request-{}.json", number_), to_json(r).dump() + "\n");
  return child_->ask(std::to_string(number_), r.rules.limit_s > 0 ? 1.2 * r.rules.limit_s + 5 : 0, kRunsKept);
}

RunRecord RunWorker::run(const RunRequest& r) {
  std::optional<ChildEnd> end = ask(r);
  if (end && end->how != ChildEnd::How::TimedOut && runs_ > 1) {
    child_.reset();
    end = ask(r);
  }
  const fs::path answer = scratch_ / fmt::format("answer-{}.json", number_);
  if (!end) {
    const RunRecord a = answer_from_json(parse_json(read_text(answer), answer.string()));
    std::error_code ignored;
    fs::remove(answer, ignored);
    fs::remove(scratch_ / fmt::format("request-{}.json", number_), ignored);
    const std::string& status = a.outcome.status;
    if (status == "error" || status == "device_lost" || status == "timed_out") child_.reset();
    // A run that could not be loaded has written nothing.
    if (status == "error" && !r.rules.out.empty()) write_failure(r, a);
    return a;
  }
  child_.reset();
  const std::string words = last_words(scratch_ / "output.txt", said_);
  RunRecord out;
  out.outcome = {end->how == ChildEnd::How::TimedOut ? "timed_out" : "crashed", "F3", -1,
                 "its process: " + end->text() + (words.empty() ? "" : "; last output: " + words)};
  out.summary = scalars_of({scene_of(r), {}, out.outcome}, "stability_");
  if (!r.rules.out.empty()) write_failure(r, out);
  return out;
}

}  // namespace clothbench
