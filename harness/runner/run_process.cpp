#include "runner/run_process.hpp"

#include <fmt/format.h>

#include <csignal>
#include <fstream>
#include <mutex>

#include "base/json_text.hpp"
#include "metrics/registry.hpp"
#include "results/raw_file.hpp"
#include "results/store.hpp"
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

}  // namespace

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
  fs::remove_all(out / (run_name(header) + ".part"), ignored);
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
    failed.outcome = {"error", "F8", -1, e.what()};
    return failed;
  }
}

int run_child_main(const fs::path& folder, const SolverLookup& lookup) {
  // Ctrl-C is the parent's to act on; here it would make a row of a run that is to be repeated.
  std::signal(SIGINT, SIG_IGN);
  serve_parent([&](const std::string& number) {
    const fs::path request = folder / ("request-" + number + ".json");
    const RunRequest r = request_from_json(parse_json(read_text(request), request.string()));
    write_file_atomically(folder / ("answer-" + number + ".json"),
                          answer_to_json(run_request(r, lookup)).dump() + "\n");
  });
  return 0;
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
  return child_->ask(std::to_string(number_), r.rules.limit_s > 0 ? 1.2 * r.rules.limit_s + 5 : 0);
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
  out.outcome = {end->how == ChildEnd::How::TimedOut ? "timed_out" : "crashed", "F8", -1,
                 "its process: " + end->text() + (words.empty() ? "" : "; last output: " + words)};
  out.summary = scalars_of({scene_of(r), {}, out.outcome}, "stability_");
  if (!r.rules.out.empty()) write_failure(r, out);
  return out;
}

}  // namespace clothbench
