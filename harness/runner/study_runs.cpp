#include "runner/study_runs.hpp"

#include <algorithm>

#include "clothbench/error.hpp"
#include "results/raw_file.hpp"
#include "runner/cell_process.hpp"
#include "runner/environment.hpp"
#include "runner/whole_run.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// As a child tells it to its parent: without series and positions.
json told(const CellRecord& c) {
  return {{"header", header_to_json(c.header)}, {"answer", to_json(CellAnswer{c.outcome, c.summary, kMissing})}};
}

CellRecord heard(const json& j) {
  CellAnswer answer = answer_from_json(j.at("answer"));
  CellRecord c;
  c.header = header_from_json(j.at("header"));
  c.outcome = std::move(answer.outcome);
  c.summary = std::move(answer.summary);
  return c;
}

}  // namespace

StudyRuns::StudyRuns(DeviceOptions device) : device_(std::move(device)) {}

StudyRuns::StudyRuns(DeviceOptions device, fs::path out, bool resume, StudyManifest manifest)
    : device_(std::move(device)), out_(std::move(out)) {
  const bool begun = fs::exists(out_ / "study.json");
  if (Guard::in_child() || (begun && resume)) return;
  if (begun)
    throw Error(out_.string() +
                ": a study is already there; give another --out, or --resume to go on with this folder");
  fs::create_directories(out_);
  manifest.created = utc_now();
  write_manifest(out_, manifest);
}

void StudyRuns::plan(const std::string& cell) const {
  StudyManifest m = read_manifest(out_);
  if (std::find(m.cells.begin(), m.cells.end(), cell) != m.cells.end()) return;
  m.cells.push_back(cell);
  write_manifest(out_, m);
}

std::optional<CellRecord> StudyRuns::stored(const PlannedCell& cell) const {
  require_same_cell(out_, cell);
  remove_leftovers(out_, cell.name);
  plan(cell.name);
  if (!cell_finished(out_, cell.name)) return std::nullopt;
  return read_cell_summary(stored_cell(out_, cell.name));
}

CellRecord StudyRuns::run(const CellSpec& spec, const std::string& protocol, const truth::Card* by) {
  if (out_.empty()) return end_of_run(spec, device_, protocol, by);
  if (auto before = stored(planned_cell(spec))) return *std::move(before);
  return whole_run(spec, device_, protocol, out_, 0, by);
}

CellRecord StudyRuns::made(const PlannedCell& cell, const std::function<CellRecord()>& make) {
  if (out_.empty()) return make();
  if (auto before = stored(cell)) return *std::move(before);
  CellRecord c = make();
  CellWriter(out_, c.header).finish(c.outcome, c.summary);
  return c;
}

void StudyRuns::store_crashed(const CellHeader& asked, const Outcome& outcome) const {
  if (out_.empty()) return;
  std::vector<CellHeader> begun;
  for (const std::string& cell : read_manifest(out_).cells) {
    const fs::path header = out_ / (cell + ".part") / "header.raw";
    if (cell_finished(out_, cell)) continue;
    if (fs::exists(header))
      begun.push_back(header_from_json(read_raw(header).header.at("cell")));
    else if (cell == cell_name(asked))
      begun.push_back(asked);
  }
  for (const CellHeader& h : begun)
    if (h.solver == asked.solver) write_failed_cell(out_, h, outcome, {});
}

std::vector<CellRecord> StudyRuns::ask(Guard& guard, const CellHeader& asked, const SolverEntry& entry,
                                       const std::function<std::vector<CellRecord>()>& work) {
  std::vector<CellRecord> out;
  const Guard::Answer answer = guard.run(entry, [&]() -> json {
    out = work();
    if (!is_external(entry.info)) return nullptr;
    json all = json::array();
    for (const CellRecord& c : out) all.push_back(told(c));
    return all;
  });
  for (const json& j : answer.value) out.push_back(heard(j));
  if (answer.crash.empty()) return out;
  out.emplace_back();
  out.back().header = asked;
  out.back().outcome = {"crashed", "F8", -1, "its process: " + answer.crash};
  if (!Guard::in_child()) store_crashed(asked, out.back().outcome);
  return out;
}

}  // namespace clothbench
