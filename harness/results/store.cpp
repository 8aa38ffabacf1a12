#include "results/store.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <climits>
#include <cmath>
#include <cstring>
#include <fstream>

#include "base/files.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"
#include "results/part_file.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

fs::path part_of(const fs::path& dir, const std::string& run) { return dir / (run + ".part"); }

fs::path write_finished(const fs::path& dir, const RunRecord& record) {
  const std::string run = run_name(record.header);
  const fs::path file = dir / (run + ".h5");
  write_hdf5(file, record);
  write_xdmf(dir / (run + ".xdmf"), file.filename().string(), record);
  return file;
}

template <class T>
void append(std::string& bytes, const std::vector<T>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// A message about the first frame and vertex whose position is not finite; empty if all are.
std::string fault_of_values(const AccuracyPass& pass, std::size_t vertices) {
  for (std::size_t k = 0; k < pass.position.size(); ++k)
    if (!std::isfinite(pass.position[k]))
      return fmt::format("the position of vertex {} in frame {} is not finite", k / 3 % vertices, k / 3 / vertices);
  for (std::size_t f = 0; f < pass.time_s.size(); ++f)
    if (!std::isfinite(pass.time_s[f]) || (f > 0 && !(pass.time_s[f] > pass.time_s[f - 1])))
      return fmt::format("the time of frame {} is not after the previous one's", f);
  return "";
}

/// Whether the run's file must have a motion; live sessions store only their last state.
bool needs_motion(const RunRecord& r) {
  const nlohmann::json& e = r.header.environment;
  return r.outcome.status == "ok" && r.header.vertices > 0 && !(e.is_object() && e.value("protocol", "") == "xr");
}

constexpr std::size_t kShown = 200;  // bytes of a path or a command that a message shows

[[noreturn]] void refuse_folder(const fs::path& folder, const std::string& why) {
  throw Error(fmt::format("{}: {}; give another --out", shortened(folder.string(), kShown), why));
}

/// Whether `path` still names the open file, which a process removes when it ends.
bool is_named(int file, const fs::path& path) {
  struct stat open_file {
  }, named{};
  return fstat(file, &open_file) == 0 && stat(path.c_str(), &named) == 0 && open_file.st_ino == named.st_ino &&
         open_file.st_dev == named.st_dev;
}

/// Locks one byte, or all if `count` is 0; false if another process holds a lock on one. Record locks work over NFS.
bool lock(int file, std::size_t first, int count) {
  struct flock range {};
  range.l_type = F_WRLCK;
  range.l_start = static_cast<off_t>(first);
  range.l_len = count;
  return fcntl(file, F_OFD_SETLK, &range) == 0 || (errno != EAGAIN && errno != EACCES);  // true without lock support
}

/// Record of a planned run without a result; its name is "<scene>__<solver>__<setting>".
RunRecord missing_run(const std::string& name, bool started) {
  RunRecord c;
  const std::size_t first = name.find("__"), last = name.rfind("__");
  c.header.scene = name.substr(0, first);
  if (first != std::string::npos && last > first) {
    c.header.solver = name.substr(first + 2, last - first - 2);
    c.header.setting = name.substr(last + 2);
  }
  c.outcome = {"missing", "ok", -1, started ? "started, not finished" : "planned, not run"};
  return c;
}

void collect_folder(const fs::path& dir, std::vector<RunRecord>& runs) {
  const std::size_t first = runs.size();
  const StudyManifest manifest = read_manifest(dir);
  for (const std::string& name : manifest.runs) {
    const fs::path file = finished_file(dir, name);
    runs.push_back(file.empty() ? missing_run(name, fs::exists(dir / (name + ".part"))) : read_run_summary(file));
  }
  // A missing run gets its scene's scenario from a run of another solver, so that tables can place it.
  for (std::size_t k = first; k < runs.size(); ++k)
    for (std::size_t j = first; j < runs.size() && runs[k].header.scenario_json.empty(); ++j)
      if (run_name(runs[j].header).starts_with(runs[k].header.scene + "__"))
        runs[k].header.scenario_json = runs[j].header.scenario_json;
}

/// Whether a summary value is a time or computed from one.
bool is_time(const std::string& name) {
  if (name == "load_s" || name == "untimed_s") return true;
  for (const char* start : {"fps_", "frame_", "bandwidth_", "stage_device_"})
    if (name.starts_with(start)) return true;
  return false;
}

}  // namespace

std::string run_name(const RunHeader& h) { return run_name(h.scene, h.solver, h.setting); }

std::string run_name(const std::string& scene, const std::string& solver, const std::string& setting) {
  std::string name = scene + "__" + solver + "__" + setting;
  for (char& c : name)
    if (!(std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '_' || c == '=' || c == '-')) c = '-';
  return name;
}

Finish best_finish() { return kWithHdf5 ? Finish::Hdf5 : Finish::Cbor; }

RunWriter::RunWriter(fs::path dir, RunHeader header, Finish finish)
    : dir_(std::move(dir)), part_(part_of(dir_, run_name(header))), finish_(finish) {
  std::error_code ec;
  fs::create_directories(dir_, ec);
  if (ec) throw Error(dir_.string() + ": cannot be created: " + ec.message(), ExitCode::CheckFailed);
  if (!fs::exists(part_)) {
    create_part(part_, header);
    return;
  }
  std::uintmax_t complete_B = 0;
  const RunRecord before = read_part(part_, &complete_B);
  const RunHeader& h = before.header;
  if (h.scenario_sha256 != header.scenario_sha256 || h.settings != header.settings)
    throw Error(fmt::format(
        "{}: holds trials of a different run (scene {} settings {}; now scene {} settings {}); give another --out",
        part_.string(), h.scenario_sha256.substr(0, 12), dump(h.settings), header.scenario_sha256.substr(0, 12),
        dump(header.settings)));
  has_replay_ = !before.replay.empty();
  fs::resize_file(part_, complete_B);  // removes an incomplete item
  // The header describes the machine as it was when the run was loaded, before the trials.
  if (before.trials.empty()) append_to_part(part_, "header", header_to_json(header));
}

void RunWriter::write_trial(const TimedTrial& trial) { append_to_part(part_, "trial", to_json(trial)); }

void RunWriter::write_frames(const AccuracyPass& pass) {
  for (; frames_ < pass.time_s.size(); ++frames_) append_to_part(part_, "frame", frame_to_json(pass, frames_), false);
}

void RunWriter::write_accuracy(const AccuracyPass& pass, const Outcome& outcome,
                               const std::map<std::string, double>& summary) {
  write_frames(pass);
  append_to_part(part_, "accuracy", to_json(pass.metrics), false);
  append_to_part(part_, "outcome", outcome_to_json(outcome, summary));
}

void RunWriter::write_replay(const std::vector<StoredGroup>& groups) {
  if (groups.empty() || has_replay_) return;
  append_to_part(part_, "replay", to_json(groups));
  has_replay_ = true;
}

fs::path RunWriter::finish(const Outcome& outcome, const std::map<std::string, double>& summary) {
  RunRecord record = read_part(part_);
  record.outcome = outcome;
  record.outcome.trajectory_sha256 = trajectory_sha256(record.accuracy);
  record.summary = summary;
  fs::path file;
  if (finish_ == Finish::Hdf5) {
    file = write_finished(dir_, record);
    fs::remove(part_);
  } else {
    append_to_part(part_, "outcome", outcome_to_json(record.outcome, summary));
    file = fs::path(part_).replace_extension(".cbor");
    publish(part_, file);
  }
  return file;
}

RunRecord RunWriter::recovered() const { return read_part(part_); }

fs::path finished_file(const fs::path& dir, const std::string& run) {
  for (const char* kind : {".h5", ".cbor"})
    if (fs::path file = dir / (run + kind); fs::exists(file)) return file;
  return {};
}

bool run_finished(const fs::path& dir, const std::string& run) { return !finished_file(dir, run).empty(); }

void remove_leftovers(const fs::path& dir, const std::string& run) {
  std::error_code ec;
  if (run_finished(dir, run)) fs::remove(part_of(dir, run), ec);
  std::vector<fs::path> stale;
  for (const auto& entry : fs::directory_iterator(dir, ec))
    for (const char* kind : {".h5", ".xdmf", ".part"})
      if (entry.path().filename().string().starts_with(run + kind + kTemporaryMark)) stale.push_back(entry.path());
  for (const fs::path& file : stale) fs::remove(file, ec);
}

RunRecord read_run(const fs::path& path) { return path.extension() == ".h5" ? read_hdf5(path, 1) : read_part(path); }

RunRecord read_run_summary(const fs::path& path) {
  RunRecord r = path.extension() == ".h5" ? read_hdf5(path, 0) : read_part(path);
  r.file = path.string();
  r.accuracy.position = {};
  r.replay = {};
  return r;
}

std::vector<std::size_t> every(std::size_t count, std::size_t stride) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < count; k += stride) out.push_back(k);
  if (count > 0 && out.back() + 1 != count) out.push_back(count - 1);
  return out;
}

Replay read_replay(const fs::path& path, std::size_t stride) {
  const bool is_hdf5 = path.extension() == ".h5";
  RunRecord run = is_hdf5 ? read_hdf5(path, stride) : read_part(path);
  Replay r;
  if (run.accuracy.position.empty()) return r;
  r.frames = every(run.accuracy.time_s.size(), stride);
  for (const std::size_t f : r.frames) r.time_s.push_back(run.accuracy.time_s[f]);
  if (is_hdf5) r.position = std::move(run.accuracy.position);
  const std::ptrdiff_t row = 3 * static_cast<std::ptrdiff_t>(run.header.vertices);
  for (std::size_t k = 0; !is_hdf5 && k < r.frames.size(); ++k) {
    const auto at = run.accuracy.position.begin() + static_cast<std::ptrdiff_t>(r.frames[k]) * row;
    r.position.insert(r.position.end(), at, at + row);
  }
  r.groups = std::move(run.replay);
  return r;
}

std::string trajectory_sha256(const AccuracyPass& pass) {
  if (pass.time_s.empty()) return "";
  std::string bytes;
  append(bytes, pass.time_s);
  append(bytes, pass.position);
  return sha256(bytes);
}

std::string trajectory_fault(const std::filesystem::path& path) {
  const RunRecord r = read_run(path);
  const AccuracyPass& pass = r.accuracy;
  if (pass.time_s.empty() && pass.position.empty()) return needs_motion(r) ? "the file has no positions" : "";
  const std::size_t expected = pass.time_s.size() * r.header.vertices * 3;
  if (pass.position.size() != expected)
    return fmt::format("expected {} coordinates of {} frames with {} vertices; found {}", expected, pass.time_s.size(),
                       r.header.vertices, pass.position.size());
  for (const MetricSeries& m : pass.metrics)
    if (m.values.size() != pass.time_s.size())
      return fmt::format("{} frames have positions, {} have {}", pass.time_s.size(), m.values.size(), m.name);
  if (r.outcome.status == "ok")
    if (std::string fault = fault_of_values(pass, r.header.vertices); !fault.empty()) return fault;
  const std::string &stored = r.outcome.trajectory_sha256, found = trajectory_sha256(pass);
  if (stored == found) return "";
  return fmt::format("the positions do not match the outcome (their SHA-256: {}, stored: {})", found.substr(0, 12),
                     stored.empty() ? "none" : stored.substr(0, 12));
}

std::vector<fs::path> import_runs(const fs::path& file_or_folder, DeviceSamples* samples) {
  if (!kWithHdf5) throw Error("import: this build has no HDF5; run it on another machine");
  std::vector<fs::path> found, files;
  if (file_or_folder.extension() == ".part")
    throw Error(file_or_folder.string() + ": not finished; `study --resume` or `run --resume` continues it");
  if (fs::is_directory(file_or_folder)) {
    for (const auto& entry : fs::directory_iterator(file_or_folder))
      if (entry.path().extension() == ".cbor") found.push_back(entry.path());
  } else if (file_or_folder.extension() == ".cbor") {
    found.push_back(file_or_folder);
  } else {
    throw Error(file_or_folder.string() + ": expected the folder of a study or a .cbor file");
  }
  std::sort(found.begin(), found.end());
  for (const fs::path& file : found) {
    RunRecord record = read_part(file);
    if (samples != nullptr) samples->attach_to(record);
    files.push_back(write_finished(file.parent_path(), record));
  }
  return files;
}

void write_manifest(const fs::path& dir, const StudyManifest& m) {
  const nlohmann::json j = {
      {"format", "clothbench-study"},   {"format_version", 1},        {"study", m.study}, {"created", m.created},
      {"command_line", m.command_line}, {"definition", m.definition}, {"runs", m.runs}};
  write_file_atomically(dir / "study.json", dump(j, 2) + "\n");
}

StudyManifest read_manifest(const fs::path& dir) {
  const fs::path file = dir / "study.json";
  std::error_code ec;
  if (!fs::is_regular_file(file, ec)) throw Error(file.string() + ": no such file; expected a study folder");
  try {
    const nlohmann::json j = json_from(content_of(file));
    return {j.at("study"), j.at("created"), j.at("command_line"), j.at("definition"), j.at("runs")};
  } catch (const nlohmann::json::exception& e) {
    throw Error(file.string() + ": not a study manifest: " + what_without_text(e));
  }
}

ResultFolder::ResultFolder(const fs::path& folder, const std::vector<std::size_t>& runs,
                           const std::string& command_line)
    : file_(folder / ".lock") {
  std::error_code ec;
  if (fs::exists(folder, ec) && !fs::is_directory(folder, ec))
    refuse_folder(folder, "it is a file; expected a folder for the result files");
  fs::create_directories(folder, ec);
  if (ec) refuse_folder(folder, "the folder cannot be made: " + ec.message());
  for (;;) {
    lock_ = open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (lock_ < 0) refuse_folder(folder, std::string("no file can be made in it: ") + std::strerror(errno));
    if (runs.empty() ? !lock(lock_, 0, 0)
                     : !std::all_of(runs.begin(), runs.end(), [&](std::size_t run) { return lock(lock_, run, 1); })) {
      const std::string by = content_of(file_);
      close(lock_);
      refuse_folder(folder, (by.empty() ? "another process" : shortened(by, kShown)) + " writes its results there");
    }
    if (is_named(lock_, file_)) break;
    close(lock_);
  }
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  const std::string text = fmt::format("process {} on {} ({})", getpid(), host.data(), command_line);
  if (ftruncate(lock_, 0) != 0 || pwrite(lock_, text.data(), text.size(), 0) < 0)
    refuse_folder(folder, std::string("no file can be written in it: ") + std::strerror(errno));
}

ResultFolder::~ResultFolder() {
  // The last process removes the file; a process that waits for the name opens a new one.
  if (lock(lock_, 0, 0) && is_named(lock_, file_)) unlink(file_.c_str());
  close(lock_);
}

void require_short_name(const fs::path& folder, const std::string& run) {
  if (run.size() > kMostRunName)
    throw Error(
        fmt::format("{}: its result files would have names of {} bytes, without the ending (such as .h5); expected at "
                    "most {}: shorten the name of the scene or the settings",
                    in_quotes(run), run.size(), kMostRunName));
  if (fs::absolute(folder).string().size() + kMostRunName + 56 > PATH_MAX)
    refuse_folder(folder, "the paths of result files in it would be too long");
}

double summary_value(const RunRecord& c, const std::string& name) {
  const auto found = c.summary.find(name);
  return found == c.summary.end() ? kMissing : found->second;
}

std::vector<RunRecord> withhold_times(std::vector<RunRecord> runs) {
  for (RunRecord& c : runs) {
    if (!(jobs_of(c) > 1)) continue;
    for (auto& [name, value] : c.summary)
      if (is_time(name) && std::isfinite(value)) {
        value = kMissing;
        c.withheld[name] = fmt::format("not timed alone: up to {:.0f} jobs ran side by side", jobs_of(c));
      }
    c.header.load_s = kMissing;
    c.trials.clear();
  }
  return runs;
}

std::vector<RunRecord> collect(const std::vector<fs::path>& results) {
  std::vector<RunRecord> runs;
  for (const fs::path& result : results) {
    if (!fs::exists(result)) throw Error(result.string() + ": no such file or folder");
    if (fs::is_directory(result))
      collect_folder(result, runs);
    else
      runs.push_back(read_run_summary(result));
  }
  return runs;
}

}  // namespace clothbench
