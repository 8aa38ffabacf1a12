#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/files.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// "<scene>__<solver>__<setting>", with characters outside [A-Za-z0-9._=-] replaced by '-'.
std::string run_name(const std::string& scene, const std::string& solver, const std::string& setting);
std::string run_name(const RunHeader&);

/// What a run ends as: one HDF5 file, or the raw files it was written to (all that a build without HDF5 can).
enum class Finish { Hdf5, Raw };
Finish best_finish();

/// Writes one run, crash-safe. Every finished trial is one raw file `<dir>/<run>.part/trial-<k>.raw` (written under
/// another name, fsync, rename), the accuracy pass one `accuracy.raw`. `finish` turns them into
/// `<dir>/<run>.h5` + `<run>.xdmf` (tmp + fsync + rename) and removes the part folder; with Finish::Raw the part
/// folder stays, with `outcome.raw` beside the trials. SIGKILL at any moment loses at most what has not been handed
/// over.
class RunWriter {
 public:
  RunWriter(std::filesystem::path dir, RunHeader header, Finish finish = best_finish());
  void write_trial(const TimedTrial&);
  void write_accuracy(const AccuracyPass&);
  /// What moved, one file `replay.raw`; known before the first frame, so a resumed run leaves it as it is.
  void write_replay(const std::vector<StoredGroup>&);
  /// Returns the path of the finished file (the .h5, or the part folder with Finish::Raw).
  std::filesystem::path finish(const Outcome&, const std::map<std::string, double>& summary);
  /// What an interrupted attempt at the same run left here (same scenario_sha256 and settings; anything else is an
  /// Error naming both): trials and accuracy pass, already valid.
  RunRecord recovered() const;

 private:
  std::filesystem::path dir_;
  RunHeader header_;
  Finish finish_;
};

/// True if `<dir>/<run>.h5` (or, without HDF5, `outcome.raw` in its part folder) exists.
bool run_finished(const std::filesystem::path& dir, const std::string& run);

/// Removes what a killed attempt at this run left behind and no reader needs: files under their temporary names, and
/// the part folder of a run whose .h5 is there. Only for the one process that works on the run.
void remove_leftovers(const std::filesystem::path& dir, const std::string& run);

/// Reads a finished file (.h5) or a part folder. Throws Error naming the file and what is wrong with it.
RunRecord read_run(const std::filesystem::path&);

/// Without positions and triangles: what tables and figures need. Cheap also for large runs.
RunRecord read_run_summary(const std::filesystem::path&);

/// What a viewer needs of a run: some of its frames, and what moved, at every frame of the scene.
struct Replay {
  std::vector<std::size_t> frames;  ///< ascending; 0 is the initial state
  std::vector<double> time_s;       ///< of each
  std::vector<float> position;      ///< (frame, vertex, xyz) [m]
  std::vector<StoredGroup>
      groups;  ///< "colliders", "colliders/0", ..., "colliders/grips"; empty without colliders and grips
};

/// 0, stride, 2 stride, ... below `count`, and the last one. `stride` at least 1.
std::vector<std::size_t> every(std::size_t count, std::size_t stride);

/// Every `stride`-th frame and the last of a finished file (.h5) or a part folder; no frames where it has no
/// trajectory. Throws Error naming the file and what is wrong with it.
Replay read_replay(const std::filesystem::path&, std::size_t stride);

class DeviceSamples;

/// Part folders of a run made without HDF5 -> the same .h5 a direct run gives, with `samples` what the device reported
/// during the run beside it. Returns the new files; a study folder's unfinished runs are passed over, but a part
/// folder that is named itself and is not finished is an Error.
std::vector<std::filesystem::path> import_raw(const std::filesystem::path& dir_or_part,
                                              const DeviceSamples* samples = nullptr);

/// `<dir>/study.json`: what the folder is. Written tmp + fsync + rename.
struct StudyManifest {
  std::string study, created, command_line;
  nlohmann::json definition;      ///< completed study file
  std::vector<std::string> runs;  ///< names of all planned runs, in order
};
void write_manifest(const std::filesystem::path& dir, const StudyManifest&);
StudyManifest read_manifest(const std::filesystem::path& dir);

}  // namespace clothbench
