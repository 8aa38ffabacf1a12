#pragma once
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "base/files.hpp"
#include "base/json_text.hpp"
#include "clothbench/record.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// "<scene>__<solver>__<setting>", with characters outside [A-Za-z0-9._=-] replaced by '-'.
std::string run_name(const std::string& scene, const std::string& solver, const std::string& setting);
std::string run_name(const RunHeader&);

/// Final form of a run: one HDF5 file, or the CBOR file that it was first written to (the only form without HDF5).
enum class Finish { Hdf5, Cbor };
Finish best_finish();

/// Writes one run, crash-safe. `<dir>/<run>.part` grows by one item per finished trial and per frame of the accuracy
/// pass (results/part_file.hpp). `finish` turns it into `<dir>/<run>.h5` + `<run>.xdmf` (tmp + fsync + rename) and
/// removes the part file; with Finish::Cbor it appends the outcome and renames the part file to `<run>.cbor`. After
/// SIGKILL, the data already passed to this object are in the file.
class RunWriter {
 public:
  /// Continues an existing part file of this run. Throws Error with both values if scenario_sha256 or settings differ.
  RunWriter(std::filesystem::path dir, RunHeader header, Finish finish = best_finish());
  void write_trial(const TimedTrial&);
  /// Writes the frames that the pass has gained since the last call.
  void write_frames(const AccuracyPass&);
  /// Writes the remaining frames, the metrics, and the outcome and summary so far, which `recovered` returns.
  void write_accuracy(const AccuracyPass&, const Outcome& = {}, const std::map<std::string, double>& summary = {});
  /// Writes colliders and grips, unless an interrupted attempt has already done so.
  void write_replay(const std::vector<StoredGroup>&);
  /// Returns the path of the finished file.
  std::filesystem::path finish(const Outcome&, const std::map<std::string, double>& summary);
  /// The complete trials and the accuracy pass that an interrupted attempt at this run stored.
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

/// Removes files of a killed attempt at this run that no reader needs: files with temporary names, and the part file of
/// a finished run. Only the process that works on the run may call this.
void remove_leftovers(const std::filesystem::path& dir, const std::string& run);

/// Reads a finished file or a part file completely. Throws Error naming the file and its fault.
RunRecord read_run(const std::filesystem::path&);

/// Reads a run without positions, `replay` and triangles of a grid, which tables and figures do not need. Fast.
RunRecord read_run_summary(const std::filesystem::path&);

/// Data of a run for a viewer: some of its frames, and colliders and grips at every frame of the scene.
struct Replay {
  std::vector<std::size_t> frames;  ///< ascending; 0 is the initial state
  std::vector<double> time_s;       ///< time of each of these frames
  std::vector<float> position;      ///< (frame, vertex, xyz) [m]
  std::vector<StoredGroup>
      groups;  ///< "colliders", "colliders/0", ..., "colliders/grips"; empty without colliders and grips
};

/// 0, stride, 2 stride, ... below `count`, and count - 1. `stride` at least 1.
std::vector<std::size_t> every(std::size_t count, std::size_t stride);

/// Reads every `stride`-th and the last frame; none without a trajectory. Throws Error naming the file and its fault.
Replay read_replay(const std::filesystem::path&, std::size_t stride);

/// SHA-256 of a motion in lower-case hexadecimal: times (float64), then positions (float32), little-endian. Files store
/// it with the outcome, so that a verdict belongs to one motion. Empty without frames.
std::string trajectory_sha256(const AccuracyPass&);

/// Fault of the motion in a result file, whatever its summary states: positions that are missing, not finite, not one
/// set per time, or that do not match the hash in `/outcome`. Empty if there is none. In a run that is not ok, frames
/// may be missing and values may be not finite. Throws Error if the file cannot be read.
std::string trajectory_fault(const std::filesystem::path&);

/// The parts of a scene that its JSON only names, as result files store them (layout in results/README.md): colliders
/// and grips at every frame, and a cloth's mesh. With them a replay needs neither the scenario's files nor this
/// program. Empty for a grid without colliders and grips.
std::vector<StoredGroup> replay_of(const Scene&);

/// For programs that do not know the kinds of colliders: adds capsules or triangles for drawing to a collider's group
/// that has neither, as arrays with the usual names and shapes, and states whether the triangles are convex. Leaves
/// unknown kinds unchanged. Throws Error or nlohmann::json::exception if something is missing or malformed.
void show_shape(StoredGroup&);

/// A stored run's scene and motion, read only from its result file.
struct StoredMotion {
  Scene scene;                  ///< complete: cloth, pins, colliders and grips with their motion
  std::vector<double> time_s;   ///< of each stored frame; frame 0 is the initial state
  std::vector<float> position;  ///< (frame, vertex, xyz) [m], time_s.size() x vertex_count() x 3 values
  /// Contact offset [m] of the solver for each collider. Empty: `margin_m` of the colliders.
  std::vector<double> contact_margins_m;
};

/// Reads a result file, and no other file. Everything is empty if the run has no trajectory. Throws Error naming the
/// file and its fault, such as a number of positions that differs from the scene.
StoredMotion read_motion(const std::filesystem::path&);

class DeviceSamples;

/// Converts runs finished without HDF5 (.cbor; a file or a study's folder) to the .h5 files that HDF5 builds write;
/// `samples`: the device's samples to store with them. Returns the new files. Throws Error for a part file.
std::vector<std::filesystem::path> import_runs(const std::filesystem::path& file_or_folder,
                                               DeviceSamples* samples = nullptr);

/// `<dir>/study.json`: the folder's study and its planned runs. Written by tmp + fsync + rename.
struct StudyManifest {
  std::string study, created, command_line;
  nlohmann::json definition;      ///< completed study file
  std::vector<std::string> runs;  ///< names of all planned runs, in order
};
void write_manifest(const std::filesystem::path& dir, const StudyManifest&);
StudyManifest read_manifest(const std::filesystem::path& dir);

/// Creates a folder for result files and locks it, so that a second process that would write the same files is refused.
/// The kernel releases locks when a process ends, so a dead process blocks nothing. Child processes need no own lock.
class ResultFolder {
 public:
  /// `runs`: numbers of the runs of a study that this process executes while other processes execute other runs; empty:
  /// no other process may write into the folder. `command_line`: for the message to a refused process. Throws Error
  /// naming the folder and the process that writes into it, or why it cannot be created or written.
  ResultFolder(const std::filesystem::path& folder, const std::vector<std::size_t>& runs,
               const std::string& command_line);
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

 private:
  std::filesystem::path file_;
  int lock_ = -1;
};

/// Maximum length [bytes] of a file's name without the endings of result files.
inline constexpr std::size_t kMostRunName = 200;

/// Throws Error if the name of this run is too long for its files in the folder.
void require_short_name(const std::filesystem::path& folder, const std::string& run);

/// Values that a device reported during runs: frame rate, bandwidth, clocks, temperature. Each series has a sampling
/// rate and the name of its source. Read from `samples.json` of scripts/quest_run.py, format 2 (results/README.md).
class DeviceSamples {
 public:
  /// Throws Error naming the file and the JSON pointer.
  explicit DeviceSamples(const std::filesystem::path& file);

  /// Stores samples as /device_samples, from 5 s before the run's first trial to 5 s after its last (all samples if
  /// trials have no times), each with the trial that contains its whole period. Samples within trials give `sampled_…`
  /// in the summary. `distrusted_trials` of the environment gets reasons to distrust times, by trial index.
  void attach_to(RunRecord&);
  /// Reasons to distrust trials, over all runs so far.
  const std::set<std::string>& reasons() const { return reasons_; }

 private:
  nlohmann::json all_;
  std::set<std::string> reasons_;
};

/// All runs of study folders, or result files, without trajectories. Planned runs without a file have the status
/// "missing". Throws Error naming a file that cannot be read.
std::vector<RunRecord> collect(const std::vector<std::filesystem::path>& results);

/// A summary value of a run; NaN if the run does not have it.
double summary_value(const RunRecord&, const std::string& name);

/// Maximum number of concurrent clothbench jobs while the run was loaded and timed; NaN if it was not timed.
inline double jobs_of(const RunRecord& c) { return summary_value(c, "jobs"); }

/// Removes times (trials and summary) of runs that were timed next to other jobs; `withheld` gets the reason.
std::vector<RunRecord> withhold_times(std::vector<RunRecord>);

}  // namespace clothbench
