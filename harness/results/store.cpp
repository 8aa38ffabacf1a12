#include "results/store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>

#include "base/files.hpp"
#include "base/json_text.hpp"
#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"
#include "results/device_samples.hpp"
#include "results/hdf5_file.hpp"
#include "results/raw_file.hpp"
#include "results/xdmf.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

fs::path part_folder(const fs::path& dir, const std::string& run) { return dir / (run + ".part"); }
fs::path trial_file(const fs::path& part, int k) { return part / fmt::format("trial-{}.raw", k); }

/// Everything in a part folder. Damaged or foreign trial files count as not there.
RunRecord read_part(const fs::path& part) {
  RunRecord record;
  const fs::path header = part / "header.raw";
  record.header = read_header(header);
  for (const auto& entry : fs::directory_iterator(part)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind("trial-", 0) != 0 || entry.path().extension() != ".raw") continue;
    try {
      record.trials.push_back(read_trial_file(entry.path()));
    } catch (const Error&) {
      continue;
    }
  }
  std::sort(record.trials.begin(), record.trials.end(), [](const auto& a, const auto& b) { return a.index < b.index; });
  if (fs::exists(part / "accuracy.raw")) record.accuracy = read_accuracy_file(part / "accuracy.raw");
  if (fs::exists(part / "replay.raw")) record.replay = read_replay_file(part / "replay.raw");
  if (fs::exists(part / "outcome.raw")) outcome_from_json(read_raw(part / "outcome.raw").header, record);
  return record;
}

fs::path write_finished(const fs::path& dir, const RunRecord& record) {
  const std::string run = run_name(record.header);
  const fs::path file = dir / (run + ".h5");
  write_hdf5(file, record);
  write_xdmf(dir / (run + ".xdmf"), file.filename().string(), record);
  return file;
}

}  // namespace

std::string run_name(const RunHeader& h) { return run_name(h.scene, h.solver, h.setting); }

std::string run_name(const std::string& scene, const std::string& solver, const std::string& setting) {
  std::string name = scene + "__" + solver + "__" + setting;
  for (char& c : name)
    if (!(std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '_' || c == '=' || c == '-')) c = '-';
  return name;
}

Finish best_finish() { return kWithHdf5 ? Finish::Hdf5 : Finish::Raw; }

RunWriter::RunWriter(fs::path dir, RunHeader header, Finish finish)
    : dir_(std::move(dir)), header_(std::move(header)), finish_(finish) {
  const fs::path part = part_folder(dir_, run_name(header_)), file = part / "header.raw";
  std::error_code ec;
  fs::create_directories(part, ec);
  if (ec) throw Error(part.string() + ": cannot be created: " + ec.message(), ExitCode::CheckFailed);
  if (fs::exists(file)) {
    const RunHeader before = read_header(file);
    if (before.scenario_sha256 != header_.scenario_sha256 || before.settings != header_.settings)
      throw Error(fmt::format(
          "{}: holds trials of another run (scene {} settings {}; now scene {} settings {}); give another --out",
          part.string(), before.scenario_sha256.substr(0, 12), before.settings.dump(),
          header_.scenario_sha256.substr(0, 12), header_.settings.dump()));
    return;
  }
  write_raw(file, {{"kind", "header"}, {"run", header_to_json(header_)}}, {});
}

void RunWriter::write_trial(const TimedTrial& trial) {
  write_trial_file(trial_file(part_folder(dir_, run_name(header_)), trial.index), trial, header_.stages.size());
}

void RunWriter::write_accuracy(const AccuracyPass& pass) {
  write_accuracy_file(part_folder(dir_, run_name(header_)) / "accuracy.raw", pass, header_.vertices);
}

void RunWriter::write_replay(const std::vector<StoredGroup>& groups) {
  const fs::path file = part_folder(dir_, run_name(header_)) / "replay.raw";
  if (!groups.empty() && !fs::exists(file)) write_replay_file(file, groups);
}

fs::path RunWriter::finish(const Outcome& outcome, const std::map<std::string, double>& summary) {
  const fs::path part = part_folder(dir_, run_name(header_));
  nlohmann::json end = outcome_to_json(outcome, summary);
  end["kind"] = "outcome";
  write_raw(part / "outcome.raw", std::move(end), {});
  if (finish_ == Finish::Raw) return part;
  const fs::path file = write_finished(dir_, read_part(part));
  fs::remove_all(part);
  return file;
}

RunRecord RunWriter::recovered() const { return read_part(part_folder(dir_, run_name(header_))); }

bool run_finished(const fs::path& dir, const std::string& run) {
  return fs::exists(dir / (run + ".h5")) || (!kWithHdf5 && fs::exists(part_folder(dir, run) / "outcome.raw"));
}

void remove_leftovers(const fs::path& dir, const std::string& run) {
  std::error_code ec;
  const fs::path part = part_folder(dir, run);
  if (kWithHdf5 && fs::exists(dir / (run + ".h5"), ec)) fs::remove_all(part, ec);
  std::vector<fs::path> stale;
  for (const auto& entry : fs::directory_iterator(part, ec))
    if (entry.path().filename().string().find(kTemporaryMark) != std::string::npos) stale.push_back(entry.path());
  for (const auto& entry : fs::directory_iterator(dir, ec)) {
    const std::string name = entry.path().filename().string();
    for (const char* kind : {".h5", ".xdmf"})
      if (name.starts_with(run + kind + kTemporaryMark)) stale.push_back(entry.path());
  }
  for (const fs::path& file : stale) fs::remove(file, ec);
}

RunRecord read_run(const fs::path& path) { return fs::is_directory(path) ? read_part(path) : read_hdf5(path, true); }
RunRecord read_run_summary(const fs::path& path) {
  return fs::is_directory(path) ? read_part(path) : read_hdf5(path, false);
}

std::vector<std::size_t> every(std::size_t count, std::size_t stride) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < count; k += stride) out.push_back(k);
  if (count > 0 && out.back() + 1 != count) out.push_back(count - 1);
  return out;
}

Replay read_replay(const fs::path& path, std::size_t stride) {
  if (!fs::is_directory(path)) return read_hdf5_replay(path, stride);
  RunRecord c = read_part(path);
  Replay r;
  const std::size_t row = 3 * static_cast<std::size_t>(c.header.vertices);
  if (c.accuracy.position.size() < row * c.accuracy.time_s.size())
    throw Error(path.string() + ": accuracy.raw: expected one set of positions for each time");
  r.frames = every(c.accuracy.time_s.size(), stride);
  for (const std::size_t f : r.frames) {
    r.time_s.push_back(c.accuracy.time_s[f]);
    const auto at = c.accuracy.position.begin() + static_cast<std::ptrdiff_t>(f * row);
    r.position.insert(r.position.end(), at, at + static_cast<std::ptrdiff_t>(row));
  }
  if (!r.frames.empty()) r.groups = std::move(c.replay);
  return r;
}

std::vector<fs::path> import_raw(const fs::path& dir_or_part, const DeviceSamples* samples) {
  if (!kWithHdf5) throw Error("import: this build has no HDF5; run it on another machine");
  if (!fs::is_directory(dir_or_part)) throw Error(dir_or_part.string() + ": expected a study folder or a .part folder");
  std::vector<fs::path> parts, files;
  // A path with a trailing slash has an empty last part.
  const fs::path normal = dir_or_part.lexically_normal(), given = normal.has_filename() ? normal : normal.parent_path();
  if (given.extension() == ".part") {
    if (!fs::exists(given / "outcome.raw"))
      throw Error(given.string() +
                  ": not finished (it has no outcome.raw); `study --resume` or `run --resume` goes on with it");
    parts.push_back(given);
  } else {
    for (const auto& entry : fs::directory_iterator(given))
      if (entry.is_directory() && entry.path().extension() == ".part") parts.push_back(entry.path());
  }
  std::sort(parts.begin(), parts.end());
  for (const fs::path& part : parts) {
    if (!fs::exists(part / "outcome.raw")) continue;  // not finished: `study --resume` goes on with it
    RunRecord record = read_part(part);
    if (samples != nullptr) samples->attach_to(record);
    files.push_back(write_finished(part.parent_path(), record));
  }
  return files;
}

void write_manifest(const fs::path& dir, const StudyManifest& m) {
  const nlohmann::json j = {
      {"format", "clothbench-study"},   {"format_version", 1},        {"study", m.study}, {"created", m.created},
      {"command_line", m.command_line}, {"definition", m.definition}, {"runs", m.runs}};
  write_file_atomically(dir / "study.json", j.dump(2) + "\n");
}

StudyManifest read_manifest(const fs::path& dir) {
  const fs::path file = dir / "study.json";
  std::error_code ec;
  if (!fs::is_regular_file(file, ec)) throw Error(file.string() + ": no such file; expected a study folder");
  try {
    std::ifstream in(file);
    const nlohmann::json j = nlohmann::json::parse(in);
    return {j.at("study"), j.at("created"), j.at("command_line"), j.at("definition"), j.at("runs")};
  } catch (const nlohmann::json::exception& e) {
    throw Error(file.string() + ": not a study manifest: " + what_without_text(e));
  }
}

}  // namespace clothbench
