#include "runner/probes.hpp"

#include <fmt/format.h>

#include <fstream>

#include "clothbench/error.hpp"
#include "results/store.hpp"
#include "runner/resume.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string prefix_of(const ProbedBy& by) { return by.map + "|" + by.solver + "|" + by.setting + "|"; }

std::string text_at(const json& line, const char* name) {
  const auto at = line.find(name);
  return at != line.end() && at->is_string() ? at->get<std::string>() : "";
}

}  // namespace

std::string ProbedBy::key(double x, double y, int seed) const {
  return fmt::format("{}{:.17g}|{:.17g}|{}", prefix_of(*this), x, y, seed);
}

Probes::Probes(fs::path file, bool resume) : file_(std::move(file)) {
  if (!resume) {
    write_file_atomically(file_, "");
    return;
  }
  std::ifstream in(file_, std::ios::binary);
  for (std::string text; std::getline(in, text) && !in.eof();) {
    whole_B_ += text.size() + 1;
    json line = json::parse(text, nullptr, false);
    if (!line.is_object() || !line.contains("key") || !line.contains("answer")) continue;
    const std::string key = line["key"];
    RunRecord answer = answer_from_json(line["answer"]);
    line.erase("answer");
    known_[key] = {std::move(line), std::move(answer)};
  }
}

void Probes::require_same(const ProbedBy& by) const {
  const std::lock_guard lock(mutex_);
  const std::string prefix = prefix_of(by);
  const auto refuse = [&](const char* what, const std::string& stored, const std::string& now) {
    throw Error(
        fmt::format("{}: results of map \"{}\" by {} {} belong to another {} ({}, now {}); results of both would be "
                    "mixed; give another --out, or undo the change",
                    file_.string(), by.map, by.solver, by.setting, what, stored, now));
  };
  for (auto at = known_.lower_bound(prefix); at != known_.end() && at->first.starts_with(prefix); ++at) {
    const json& line = at->second.line;
    const std::string scenario = text_at(line, "scenario_sha256"), definition = text_at(line, "definition_sha256"),
                      version = text_at(line, "solver_version");
    if (scenario != by.scenario_sha256) refuse("scene", short_hash(scenario), short_hash(by.scenario_sha256));
    if (definition != by.definition_sha256)
      refuse("definition of the map or its settings", short_hash(definition), short_hash(by.definition_sha256));
    if (!version.empty() && !by.solver_version.empty() && version != by.solver_version)
      refuse("version of the solver", version, by.solver_version);
  }
}

const RunRecord* Probes::find(const std::string& key) const {
  const std::lock_guard lock(mutex_);
  const auto at = known_.find(key);
  return at == known_.end() ? nullptr : &at->second.answer;
}

const RunRecord& Probes::add(const ProbedBy& by, const std::string& key, const RunRecord& a) {
  const std::lock_guard lock(mutex_);
  const json line = {{"key", key},
                     {"scenario_sha256", by.scenario_sha256},
                     {"definition_sha256", by.definition_sha256},
                     {"solver_version", by.solver_version}};
  json whole = line;
  whole["answer"] = answer_to_json(a);
  const std::string text = whole.dump() + "\n";
  std::error_code error;
  // Onto a torn line nothing may be appended: both would be lost.
  if (fs::exists(file_, error) && fs::file_size(file_) > whole_B_) fs::resize_file(file_, whole_B_);
  std::ofstream out(file_, std::ios::app | std::ios::binary);
  out << text;
  out.flush();
  if (!out) throw Error(file_.string() + ": cannot be written", ExitCode::CheckFailed);
  whole_B_ += text.size();
  Known& known = known_[key];
  known = {line, a};
  return known.answer;
}

}  // namespace clothbench
