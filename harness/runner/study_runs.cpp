#include "runner/study_runs.hpp"

#include <algorithm>

#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "runner/environment.hpp"
#include "runner/run_process.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

}  // namespace

StudyRuns::StudyRuns(DeviceOptions device) : device_(std::move(device)) {}

StudyRuns::StudyRuns(DeviceOptions device, fs::path out, bool resume, StudyManifest manifest)
    : device_(std::move(device)), out_(std::move(out)) {
  const bool begun = fs::exists(out_ / "study.json");
  if (Guard::in_child() || (begun && resume)) return;
  if (begun)
    throw Error(out_.string() +
                ": a study is already there; give another --out, or --resume to continue in this folder");
  manifest.created = utc_now();
  write_manifest(out_, manifest);
}

void StudyRuns::plan(const std::string& run) const {
  StudyManifest m = read_manifest(out_);
  if (contains(m.runs, run)) return;
  m.runs.push_back(run);
  write_manifest(out_, m);
}

std::optional<RunRecord> StudyRuns::stored(const PlannedRun& run) const {
  require_same_run(out_, run);
  remove_leftovers(out_, run.name);
  plan(run.name);
  if (!run_finished(out_, run.name)) return std::nullopt;
  return read_run_summary(stored_run(out_, run.name));
}

RunRecord StudyRuns::run(const RunSpec& spec, const std::string& protocol, const truth::ReferenceCase* by) {
  if (out_.empty()) return end_of_run(spec, {device_, protocol, {}, 0, by});
  if (auto before = stored(planned_run(spec))) return *std::move(before);
  return whole_run(spec, {device_, protocol, out_, 0, by});
}

RunRecord StudyRuns::made(const PlannedRun& run, const std::function<RunRecord()>& make) {
  if (out_.empty()) return make();
  if (auto before = stored(run)) return *std::move(before);
  RunRecord c = make();
  RunWriter(out_, c.header).finish(c.outcome, c.summary);
  return c;
}

void StudyRuns::store_crashed(const RunHeader& asked, const Outcome& outcome) const {
  if (out_.empty()) return;
  std::vector<RunHeader> begun;
  for (const std::string& run : read_manifest(out_).runs) {
    const fs::path part = out_ / (run + ".part");
    if (run_finished(out_, run)) continue;
    if (fs::exists(part))
      begun.push_back(read_run_summary(part).header);
    else if (run == run_name(asked))
      begun.push_back(asked);
  }
  for (const RunHeader& h : begun)
    if (h.solver == asked.solver) write_failed_run(out_, h, outcome, {});
}

std::vector<RunRecord> StudyRuns::ask(Guard& guard, const RunHeader& asked, const SolverEntry& entry,
                                      const std::function<std::vector<RunRecord>()>& work) {
  std::vector<RunRecord> out;
  const Guard::Answer answer = guard.run(entry, [&]() -> json {
    out = work();
    if (!is_external(entry.info)) return nullptr;
    json all = json::array();
    for (const RunRecord& c : out) all.push_back(answer_to_json(c, true));
    return all;
  });
  for (const json& j : answer.value) out.push_back(answer_from_json(j));
  if (answer.crash.empty()) return out;
  out.emplace_back();
  out.back().header = asked;
  out.back().outcome = {"crashed", "F3", -1, "its process: " + answer.crash};
  if (!Guard::in_child()) store_crashed(asked, out.back().outcome);
  return out;
}

}  // namespace clothbench
