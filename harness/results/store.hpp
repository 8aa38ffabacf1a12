#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "base/files.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// "<scene>__<solver>__<setting>", with characters outside [A-Za-z0-9._=-] replaced by '-'.
std::string run_name(const std::string& scene, const std::string& solver, const std::string& setting);
std::string run_name(const RunHeader&);

/// Final form of a run: one HDF5 file, or the CBOR file that it was first written to (the only form without HDF5).
enum class Finish { Hdf5, Cbor };
Finish best_finish();

/// Writes one run, crash-safe. `<dir>/<run>.part` grows by one item for each finished trial and for each frame of the
/// accuracy pass (results/part_file.hpp). `finish` turns it into `<dir>/<run>.h5` + `<run>.xdmf` (tmp + fsync + rename)
/// and removes it; with Finish::Cbor it appends the outcome and renames the file to `<run>.cbor`. SIGKILL at any moment
/// loses at most data not yet passed to this class.
class RunWriter {
 public:
  /// Continues a part file of the same run. Throws Error naming both if scenario_sha256 or settings differ.
  RunWriter(std::filesystem::path dir, RunHeader header, Finish finish = best_finish());
  void write_trial(const TimedTrial&);
  /// Writes the frames of a pass that has more than before.
  void write_frames(const AccuracyPass&);
  /// Writes the rest of its frames, its metrics, and how it ended with what else is known of it: `recovered` returns
  /// both as outcome and summary of the run so far.
  void write_accuracy(const AccuracyPass&, const Outcome& = {}, const std::map<std::string, double>& summary = {});
  /// Writes colliders and grips, unless an interrupted attempt has written them.
  void write_replay(const std::vector<StoredGroup>&);
  /// Returns the path of the finished file.
  std::filesystem::path finish(const Outcome&, const std::map<std::string, double>& summary);
  /// The complete trials and accuracy pass that an interrupted attempt at the same run left here.
  RunRecord recovered() const;

 private:
  std::filesystem::path dir_, part_;
  Finish finish_;
  bool has_replay_ = false;
  std::size_t frames_ = 0;  ///< written by this object
};

/// `<dir>/<run>.h5` or `.cbor`, whichever exists; empty if the run is not finished.
std::filesystem::path finished_file(const std::filesystem::path& dir, const std::string& run);
bool run_finished(const std::filesystem::path& dir, const std::string& run);

/// Removes files that a killed attempt at this run left and no reader needs: files with temporary names, and the part
/// file of a finished run. Only the process that works on the run may call this.
void remove_leftovers(const std::filesystem::path& dir, const std::string& run);

/// Reads a finished file or a part file, whole. Throws Error naming the file and what is wrong with it.
RunRecord read_run(const std::filesystem::path&);

/// Without positions, `replay` and triangles of a grid, which tables and figures do not need. Fast also for large runs.
RunRecord read_run_summary(const std::filesystem::path&);

/// Data of a run for a viewer: some of its frames, and colliders and grips at every frame of the scene.
struct Replay {
  std::vector<std::size_t> frames;  ///< ascending; 0 is the initial state
  std::vector<double> time_s;       ///< of each
  std::vector<float> position;      ///< (frame, vertex, xyz) [m]
  std::vector<StoredGroup>
      groups;  ///< "colliders", "colliders/0", ..., "colliders/grips"; empty without colliders and grips
};

/// 0, stride, 2 stride, ... below `count`, and count - 1. `stride` at least 1.
std::vector<std::size_t> every(std::size_t count, std::size_t stride);

/// Every `stride`-th frame and the last; no frames if the file has no trajectory. Throws Error naming the file and what
/// is wrong with it.
Replay read_replay(const std::filesystem::path&, std::size_t stride);

/// SHA-256 of a motion in lower-case hexadecimal: the times (float64), then the positions (float32), little-endian.
/// Files store it with the outcome, so that a verdict belongs to one motion. Empty without frames.
std::string trajectory_sha256(const AccuracyPass&);

/// The fault of the motion in a result file, whatever its summary states: positions that are missing, not finite,
/// not one set for each time, or positions that do not match the hash in `/outcome`. Empty if nothing is wrong. A run
/// that did not end well may lack frames and have values that are not finite. Throws Error naming the file if it cannot
/// be read.
std::string trajectory_fault(const std::filesystem::path&);

class DeviceSamples;

/// Converts runs that a build without HDF5 finished (.cbor; a file or a study's folder) to .h5 files, as a build with
/// HDF5 writes them. `samples`: the device's samples to store with them. Returns the new files. Throws Error if
/// `file_or_folder` is a part file, which is not finished.
std::vector<std::filesystem::path> import_runs(const std::filesystem::path& file_or_folder,
                                               DeviceSamples* samples = nullptr);

/// `<dir>/study.json`: the study of the folder and its planned runs. Written by tmp + fsync + rename.
struct StudyManifest {
  std::string study, created, command_line;
  nlohmann::json definition;      ///< completed study file
  std::vector<std::string> runs;  ///< names of all planned runs, in order
};
void write_manifest(const std::filesystem::path& dir, const StudyManifest&);
StudyManifest read_manifest(const std::filesystem::path& dir);

/// Values that a device reported during runs: frame rate, bandwidth, clocks, temperature. Each series has the sampling
/// rate and the name of its source. `samples.json` of scripts/quest_run.py, format 2 (results/README.md).
class DeviceSamples {
 public:
  /// Throws Error naming the file and the JSON pointer.
  explicit DeviceSamples(const std::filesystem::path& file);

  /// Stores samples as /device_samples, from 5 s before the run's first trial to 5 s after its last (all, if the times
  /// of trials are not known), each with the trial that contains its whole period. Samples inside trials give
  /// `sampled_…` in the summary. `distrusted_trials` of the environment: the reasons not to trust a trial, by index.
  void attach_to(RunRecord&);
  /// The reasons against trials of all runs so far.
  const std::set<std::string>& reasons() const { return reasons_; }

 private:
  nlohmann::json all_;
  std::set<std::string> reasons_;
};

/// All runs of study folders, or result files, without trajectories. Planned runs without a file have the
/// status "missing". Throws Error naming the file that cannot be read.
std::vector<RunRecord> collect(const std::vector<std::filesystem::path>& results);

/// A summary value of a run; NaN if the run does not have it.
double summary_value(const RunRecord&, const std::string& name);

/// Maximum number of concurrent clothbench jobs while the run was loaded and timed; NaN if it was not timed.
inline double jobs_of(const RunRecord& c) { return summary_value(c, "jobs"); }

/// The runs; one that was timed beside other jobs has no times (trials and summary), and the reason in `withheld`.
std::vector<RunRecord> withhold_times(std::vector<RunRecord>);

}  // namespace clothbench
