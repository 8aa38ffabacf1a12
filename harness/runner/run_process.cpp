#include "runner/run_process.hpp"

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <mutex>

#include "base/json_number.hpp"
#include "base/json_text.hpp"
#include "metrics/registry.hpp"
#include "results/replay.hpp"
#include "results/store.hpp"
#include "runner/solver_run.hpp"
#include "runner/whole_run.hpp"
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
void write_failure(const RunRequest& r, const RunAnswer& answer) {
  static std::mutex mutex;  // the HDF5 library is not for several threads
  const std::lock_guard lock(mutex);
  const Scene scene = scene_of(r);
  const RunHeader h = header_of(scene, r.solver, r.setting, r.settings, r.protocol);
  if (!run_finished(r.out, run_name(h))) write_failed_run(r.out, h, answer.outcome, answer.summary);
}

RunAnswer run_here(const RunRequest& r, const SolverLookup& lookup) {
  const auto began = std::chrono::steady_clock::now();
  const Scene scene = scene_of(r);
  const SolverEntry& entry = lookup(r.solver);
  const json settings = entry.make ? complete_settings(entry.info, r.settings) : r.settings;
  const RunRecord record = whole_run({&scene, &entry, settings, r.setting}, r.device, r.protocol, r.out, r.limit_s);
  RunAnswer answer{record.outcome, record.summary, kMissing};
  answer.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return answer;
}

}  // namespace

json to_json(const RunRequest& r) {
  return {{"scenario", r.scenario},
          {"source", r.source},
          {"set", r.set},
          {"name", r.name},
          {"solver", r.solver},
          {"setting", r.setting},
          {"settings", r.settings},
          {"device", r.device.index},
          {"validate", r.device.validation},
          {"profile", r.device.profile},
          {"protocol", r.protocol},
          {"limit_s", r.limit_s},
          {"out", r.out.string()}};
}

RunRequest request_from_json(const json& j) {
  RunRequest r;
  r.scenario = j.at("scenario");
  r.source = j.at("source");
  r.set = j.at("set").get<std::vector<std::string>>();
  r.name = j.at("name");
  r.solver = j.at("solver");
  r.setting = j.at("setting");
  r.settings = j.at("settings");
  r.device.index = j.at("device");
  r.device.validation = j.at("validate");
  r.device.profile = j.at("profile");
  r.protocol = j.at("protocol");
  r.limit_s = j.at("limit_s");
  r.out = j.at("out").get<std::string>();
  return r;
}

json to_json(const RunAnswer& a) {
  return {{"status", a.outcome.status},        {"class", a.outcome.klass},   {"failed_frame", a.outcome.failed_frame},
          {"message", a.outcome.message},      {"expect", a.outcome.expect}, {"summary", numbers_to_json(a.summary)},
          {"wall_s", number_to_json(a.wall_s)}};
}

RunAnswer answer_from_json(const json& j) {
  RunAnswer a;
  a.outcome = {j.at("status"), j.at("class"), j.at("failed_frame"), j.at("message"), j.value("expect", "")};
  a.summary = numbers_from_json(j.at("summary"));
  a.wall_s = number_from_json(j.at("wall_s"), "wall_s");
  return a;
}

void write_failed_run(const fs::path& out, const RunHeader& header, const Outcome& outcome,
                      const std::map<std::string, double>& summary) {
  std::error_code ignored;
  fs::remove_all(out / (run_name(header) + ".part"), ignored);
  RunWriter(out, header).finish(outcome, summary);
}

RunAnswer run_request(const RunRequest& r, const SolverLookup& lookup) {
  try {
    return run_here(r, lookup);
  } catch (const std::exception& e) {  // what a solver cannot load is a row of the table, whatever it throws
    RunAnswer answer;
    answer.outcome = {"error", "F8", -1, e.what()};
    return answer;
  }
}

int run_child_main(const fs::path& folder, const SolverLookup& lookup) {
  // Ctrl-C is the parent's to act on; here it would make a row of a run that is to be repeated.
  std::signal(SIGINT, SIG_IGN);
  serve_parent([&](const std::string& number) {
    const fs::path request = folder / ("request-" + number + ".json");
    const RunRequest r = request_from_json(parse_json(read_text(request), request.string()));
    write_file_atomically(folder / ("answer-" + number + ".json"), to_json(run_request(r, lookup)).dump() + "\n");
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
  return child_->ask(std::to_string(number_), r.limit_s > 0 ? 1.2 * r.limit_s + 5 : 0);
}

RunAnswer RunWorker::run(const RunRequest& r) {
  std::optional<ChildEnd> end = ask(r);
  if (end && end->how != ChildEnd::How::TimedOut && runs_ > 1) {
    child_.reset();
    end = ask(r);
  }
  const fs::path answer = scratch_ / fmt::format("answer-{}.json", number_);
  if (!end) {
    const RunAnswer a = answer_from_json(parse_json(read_text(answer), answer.string()));
    std::error_code ignored;
    fs::remove(answer, ignored);
    fs::remove(scratch_ / fmt::format("request-{}.json", number_), ignored);
    const std::string& status = a.outcome.status;
    if (status == "error" || status == "device_lost" || status == "timed_out") child_.reset();
    // A run that could not be loaded has written nothing.
    if (status == "error" && !r.out.empty()) write_failure(r, a);
    return a;
  }
  child_.reset();
  const std::string words = last_words(scratch_ / "output.txt", said_);
  RunAnswer out;
  out.wall_s = end->wall_s;
  out.outcome = {end->how == ChildEnd::How::TimedOut ? "timed_out" : "crashed", "F8", -1,
                 "its process: " + end->text() + (words.empty() ? "" : "; last words: " + words)};
  out.summary = scalars_of({scene_of(r), {}, out.outcome}, "stability_");
  if (!r.out.empty()) write_failure(r, out);
  return out;
}

}  // namespace clothbench
