#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>

#include "clothbench/error.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

nlohmann::json header_to_json(const RunHeader&);
RunHeader header_from_json(const nlohmann::json&);

/// Outcome and summary of a run; also part of a child process's answer.
nlohmann::json outcome_to_json(const Outcome&, const std::map<std::string, double>& summary);
void outcome_from_json(const nlohmann::json&, RunRecord&);

/// A series of a trial: one value per frame, or per frame and stage. An optional series is empty unless measured.
struct TrialSeries {
  const char *group, *name, *units, *long_name;  ///< group: of the HDF5 file
  std::vector<double> TimedTrial::*values;
  bool by_stage = false, optional = false;
};
inline constexpr TrialSeries kTrialSeries[] = {
    {"timing", "frame_wall_s", "s", "wall time of a frame", &TimedTrial::frame_wall_s},
    {"timing", "frame_device_s", "s", "device time of a frame, first to last timestamp", &TimedTrial::frame_device_s},
    {"timing", "frame_rendered_s", "s", "wall time of a frame with its rendering", &TimedTrial::frame_rendered_s, false,
     true},
    {"timing", "frame_cpu_s", "s", "CPU time of a frame, of all threads of the process", &TimedTrial::frame_cpu_s,
     false, true},
    {"timing", "stage_device_s", "s", "device time of a stage, in a separate run", &TimedTrial::stage_device_s, true},
    {"bandwidth", "read_B", "B", "bytes loaded by shaders, counted in a separate run", &TimedTrial::stage_read_B, true},
    {"bandwidth", "write_B", "B", "bytes stored by shaders, counted in a separate run", &TimedTrial::stage_write_B,
     true},
};

struct TrialNumber {
  const char *name, *units, *long_name;
  double TimedTrial::*value;
};
inline constexpr TrialNumber kTrialNumbers[] = {
    {"pipelined_wall_s", "s", "mean wall time of a frame, two in flight", &TimedTrial::pipelined_wall_s},
    {"trial_start_unix_s", "s", "when the trial's first timed frame began, since 1970 UTC", &TimedTrial::start_unix_s},
    {"trial_end_unix_s", "s", "when the trial's last timed frame ended, since 1970 UTC", &TimedTrial::end_unix_s},
    {"jobs", "1", "clothbench jobs on the machine during the trial, this one included", &TimedTrial::jobs},
    {"cpu_clock_Hz", "Hz", "clock of the fastest CPU core after the trial", &TimedTrial::cpu_clock_Hz},
    {"gpu_clock_Hz", "Hz", "clock of the GPU after the trial", &TimedTrial::gpu_clock_Hz},
    {"temperature_C", "degC", "temperature of the hottest zone after the trial", &TimedTrial::temperature_C},
    {"gpu_power_W", "W", "mean power of the GPU", &TimedTrial::gpu_power_W},
    {"power_W", "W", "mean power of CPU packages, or power drawn from the battery", &TimedTrial::power_W},
};

nlohmann::json to_json(const TimedTrial&);
nlohmann::json to_json(const std::vector<MetricSeries>&);
/// Time and positions of frame k of the pass.
nlohmann::json frame_to_json(const AccuracyPass&, std::size_t k);
nlohmann::json to_json(const std::vector<StoredGroup>&);

/// A run while it is measured: a sequence of CBOR items (RFC 8949, RFC 8742), each an object with one member. On a
/// device without HDF5 this is the final form. In order: "header"; "replay"; one "frame" per frame of the untimed pass;
/// the pass's metrics as "accuracy" and its end as "outcome"; one "trial" per trial; "outcome" of the whole run. If an
/// item occurs twice (for trials: with the same index), the later one holds; frame 0 restarts the pass. Numeric series
/// are little-endian byte strings, as in memory.

/// Creates the file with its header, completely or not at all.
void create_part(const std::filesystem::path&, const RunHeader&);

/// Appends an item and, if `sync`, calls fsync. Throws Error naming the file, and restores the file if possible.
void append_to_part(const std::filesystem::path&, const char* kind, nlohmann::json body, bool sync = true);

/// Reads all complete items and ignores the rest: a killed process leaves an incomplete item at the end. `complete_B`:
/// set to their length. Throws Error naming the file if it has no header or an invalid item.
RunRecord read_part(const std::filesystem::path&, std::uintmax_t* complete_B = nullptr);

#ifdef CLOTHBENCH_HAS_HDF5
inline constexpr bool kWithHdf5 = true;

/// Writes one result file (layout in results/README.md) by tmp + fsync + rename. Throws Error naming the file.
void write_hdf5(const std::filesystem::path&, const RunRecord&);

/// Reads a file with positions of every `stride`-th and the last frame; 0: no positions, replay or grid triangles.
RunRecord read_hdf5(const std::filesystem::path&, std::size_t stride);

/// Writes a sidecar file for opening the trajectory and the static meshes in ParaView: per frame a grid over
/// /frames/NNNNNN of `h5_name`, or a collection of the cloth and the static meshes if there are any.
void write_xdmf(const std::filesystem::path&, const std::string& h5_name, const RunRecord&);
#else
inline constexpr bool kWithHdf5 = false;

inline void write_hdf5(const std::filesystem::path& path, const RunRecord&) {
  throw Error(path.string() + ": this build writes no HDF5; convert the run with `clothbench import` elsewhere");
}
inline RunRecord read_hdf5(const std::filesystem::path& path, std::size_t) {
  throw Error(path.string() + ": this build reads no HDF5");
}
inline void write_xdmf(const std::filesystem::path&, const std::string&, const RunRecord&) {}
#endif

}  // namespace clothbench
