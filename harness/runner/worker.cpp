#include "runner/worker.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <unistd.h>

#include <atomic>
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
#include "results/replay.hpp"
#include "results/store.hpp"
#include "runner/expect.hpp"
#include "runner/interrupt.hpp"
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

/// A new folder for a worker's files.
fs::path scratch_folder() {
  static std::atomic<int> made{0};
  return fs::temp_directory_path() / fmt::format("clothbench-call-{}-{}", getpid(), ++made);
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
    // A parent that was killed before prctl sends no signal any more, but its end of the socket is closed.
    pollfd parent{STDIN_FILENO, POLLIN, 0};
    if (poll(&parent, 1, 0) > 0 && (parent.revents & POLLHUP) != 0) return;
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

RunRecord whole_run(const RunSpec& spec, const RunRules& rules) {
  SolverRun run(spec, rules.device, rules.protocol);
  RunRecord record;
  record.header = run.header();
  std::unique_ptr<RunWriter> writer;
  if (!rules.out.empty()) writer = std::make_unique<RunWriter>(rules.out, run.header());
  TrialRules pass;
  pass.trials = 0;
  pass.accuracy_duration_s = spec.scene->time.duration_s;
  pass.run_limit_s = rules.limit_s;
  if (run.alive()) record.accuracy = run.run_accuracy(pass);
  record.outcome = run.outcome();
  if (const int messages = run.validation_messages(); messages > 0)
    record.outcome = {"error", "ok", -1, fmt::format("{} validation messages", messages)};
  record.summary = summarise(run.spec(), run.plan(), record);
  Verdict verdict = judge(*spec.scene, record.outcome, record.accuracy, record.summary);
  record.outcome.expect = std::move(verdict.text);
  record.summary.merge(verdict.scalars);
  if (!writer) return record;
  if (!record.accuracy.time_s.empty()) {
    writer->write_replay(replay_of(*spec.scene));
    writer->write_accuracy(record.accuracy);
  }
  writer->finish(record.outcome, record.summary);
  return record;
}

RunRecord run_request(const RunRequest& r, const SolverLookup& lookup) {
  try {
    const Scene scene = scene_of(r);
    const SolverEntry* known = lookup(r.solver);
    const SolverEntry& entry = known != nullptr ? *known : find_solver(r.solver);  // says what there is
    return whole_run({&scene, &entry, entry.make ? complete_settings(entry.info, r.settings) : r.settings, r.setting},
                     r.rules);
  } catch (const std::exception& e) {  // what a solver cannot load is a row of the table, whatever it throws
    RunRecord failed;
    failed.outcome = {"error", "F3", -1, e.what()};
    return failed;
  }
}

int run_child_main(const fs::path& folder, const SolverLookup& lookup, WorkerFunctions functions) {
  functions["run"] = [&](const json& request, const WorkerProgress&) {
    return answer_to_json(run_request(request_from_json(request), lookup));
  };
  serve_parent([&](const std::string& number) {
    const fs::path file = folder / ("request-" + number + ".json");
    const json answer = answer_of(functions, parse_json(read_text(file), file.string()));
    write_file_atomically(folder / ("answer-" + number + ".json"), answer.dump() + "\n");
  });
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

Worker::Worker(fs::path program, fs::path scratch, bool keep_output)
    : program_(std::move(program)), scratch_(std::move(scratch)), keep_output_(keep_output) {}

Worker::Worker(fs::path program) : Worker(std::move(program), scratch_folder(), false) {}

Worker::~Worker() {
  std::error_code ignored;
  child_.reset();
  if (!keep_output_) fs::remove_all(scratch_, ignored);
}

WorkerAnswer Worker::call(const std::string& function, const json& request, double limit_s, const char* interrupted,
                          const std::function<double(const std::string&, std::size_t, std::size_t)>& heard) {
  constexpr int kRunsAChild = 100;  // what drivers leak is theirs to keep for so long
  const fs::path log = keep_output_ ? scratch_ / "output.txt" : fs::path();
  if (runs_ == kRunsAChild) child_.reset();
  if (!child_) {
    fs::create_directories(scratch_);
    const fs::path program = program_.empty() ? own_program() : program_;
    child_ = std::make_unique<Child>(std::vector<std::string>{program.string(), "run-child", scratch_.string()}, log);
    ++children_;
    runs_ = 0;
  }
  std::error_code ignored;
  said_ = runs_ == 0 || !keep_output_ ? 0 : fs::file_size(log, ignored);
  ++number_;
  ++runs_;
  const fs::path asked = scratch_ / fmt::format("request-{}.json", number_),
                 answered = scratch_ / fmt::format("answer-{}.json", number_);
  write_file_atomically(asked, json{{"function", function}, {"request", request}}.dump() + "\n");
  const std::optional<ChildEnd> end = child_->ask(std::to_string(number_), limit_s, interrupted, [&](auto& line) {
    std::istringstream words(line);
    std::size_t done = 0, total = 0;
    words >> done >> total;
    std::string what;
    std::getline(words >> std::ws, what);
    return heard ? heard(what, done, total) : limit_s;
  });
  if (end) {
    child_.reset();
    return {nullptr, end};
  }
  const json answer = parse_json(read_text(answered), answered.string());
  for (const fs::path& file : {asked, answered}) fs::remove(file, ignored);
  if (answer.contains("error"))
    throw Error(answer["error"].get<std::string>(), static_cast<ExitCode>(answer["code"].get<int>()));
  return {answer["value"]};
}

RunRecord Worker::run(const RunRequest& r) {
  const json request = to_json(r);
  const double limit_s = r.rules.limit_s > 0 ? 1.2 * r.rules.limit_s + 5 : 0;
  WorkerAnswer answer = call("run", request, limit_s, kRunsKept);
  if (answer.end && answer.end->how != ChildEnd::How::TimedOut && runs_ > 1)
    answer = call("run", request, limit_s, kRunsKept);
  if (!answer.end) {
    const RunRecord a = answer_from_json(answer.value);
    const std::string& status = a.outcome.status;
    if (status == "error" || status == "device_lost" || status == "timed_out") child_.reset();
    // A run that could not be loaded has written nothing.
    if (status == "error" && !r.rules.out.empty()) write_failure(r, a);
    return a;
  }
  const std::string words = last_words(scratch_ / "output.txt", said_);
  RunRecord out;
  out.outcome = {answer.end->how == ChildEnd::How::TimedOut ? "timed_out" : "crashed", "F3", -1,
                 "its process: " + answer.end->text() + (words.empty() ? "" : "; last output: " + words)};
  out.summary = scalars_of({scene_of(r), {}, out.outcome}, "stability_");
  if (!r.rules.out.empty()) write_failure(r, out);
  return out;
}

WorkerAnswer guarded(Worker& worker, const std::string& function, const json& request,
                     const std::function<json(const json&)>& work) {
  return solvers_in_process() ? WorkerAnswer{work(request)}
                              : worker.call(function, request, solver_limit_s(), "interrupted");
}

}  // namespace clothbench
