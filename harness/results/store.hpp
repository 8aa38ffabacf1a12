#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/files.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// "<scene>__<solver>__<setting>", with characters outside [A-Za-z0-9._=-] replaced by '-'.
std::string run_name(const std::string& scene, const std::string& solver, const std::string& setting);
std::string run_name(const RunHeader&);

/// Final form of a run: one HDF5 file, or the raw files it was first written to (the only form without HDF5).
enum class Finish { Hdf5, Raw };
Finish best_finish();

/// Writes one run, crash-safe. Every finished trial is a raw file `<dir>/<run>.part/trial-<k>.raw` (written under
/// another name, fsync, rename); the accuracy pass is `accuracy.raw`. `finish` turns them into
/// `<dir>/<run>.h5` + `<run>.xdmf` (tmp + fsync + rename) and removes the part folder; with Finish::Raw the part
/// folder stays, with `outcome.raw` beside the trials. SIGKILL at any moment loses at most data not yet passed to
/// this class.
class RunWriter {
 public:
  RunWriter(std::filesystem::path dir, RunHeader header, Finish finish = best_finish());
  void write_trial(const TimedTrial&);
  void write_accuracy(const AccuracyPass&);
  /// Writes colliders and grips, `replay.raw`. They are known before the first frame, so a resumed run keeps the file.
  void write_replay(const std::vector<StoredGroup>&);
  /// Returns the path of the finished file (the .h5, or the part folder with Finish::Raw).
  std::filesystem::path finish(const Outcome&, const std::map<std::string, double>& summary);
  /// The valid trials and accuracy pass that an interrupted attempt at the same run left here. Throws Error naming both
  /// if scenario_sha256 or settings differ.
  RunRecord recovered() const;

 private:
  std::filesystem::path dir_;
  RunHeader header_;
  Finish finish_;
};

/// True if `<dir>/<run>.h5` (or, without HDF5, `outcome.raw` in its part folder) exists.
bool run_finished(const std::filesystem::path& dir, const std::string& run);

/// Removes files that a killed attempt at this run left and no reader needs: files with temporary names, and the part
/// folder of a run whose .h5 exists. Only the process that works on the run may call this.
void remove_leftovers(const std::filesystem::path& dir, const std::string& run);

/// Reads a finished file (.h5) or a part folder. Throws Error naming the file and what is wrong with it.
RunRecord read_run(const std::filesystem::path&);

/// Without positions, nor triangles of a grid, which tables and figures do not need. Fast also for large runs.
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

/// Every `stride`-th frame and the last, from a finished file (.h5) or a part folder; no frames if it has no
/// trajectory. Throws Error naming the file and what is wrong with it.
Replay read_replay(const std::filesystem::path&, std::size_t stride);

class DeviceSamples;

/// Converts part folders of runs made without HDF5 to the .h5 files that direct runs give; `samples`: the device's
/// samples to store with them. Returns the new files. Skips unfinished runs of a study folder; throws Error if
/// `dir_or_part` is itself an unfinished part folder.
std::vector<std::filesystem::path> import_raw(const std::filesystem::path& dir_or_part,
                                              const DeviceSamples* samples = nullptr);

/// `<dir>/study.json`: the study of the folder and its planned runs. Written by tmp + fsync + rename.
struct StudyManifest {
  std::string study, created, command_line;
  nlohmann::json definition;      ///< completed study file
  std::vector<std::string> runs;  ///< names of all planned runs, in order
};
void write_manifest(const std::filesystem::path& dir, const StudyManifest&);
StudyManifest read_manifest(const std::filesystem::path& dir);

}  // namespace clothbench
