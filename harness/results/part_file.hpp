#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>

#include "clothbench/record.hpp"

namespace clothbench {

nlohmann::json header_to_json(const RunHeader&);
RunHeader header_from_json(const nlohmann::json&);

/// How a run ended and its summary: what a child process answers, too.
nlohmann::json outcome_to_json(const Outcome&, const std::map<std::string, double>& summary);
void outcome_from_json(const nlohmann::json&, RunRecord&);

/// A series of a trial: one value per frame, or per frame and stage. An optional one is empty unless it was measured.
struct TrialSeries {
  const char *group, *name, *units, *long_name;  ///< group: of the HDF5 file
  std::vector<double> TimedTrial::*values;
  bool by_stage = false, optional = false;
};
inline constexpr TrialSeries kTrialSeries[] = {
    {"timing", "frame_wall_s", "s", "wall time of a frame", &TimedTrial::frame_wall_s},
    {"timing", "frame_device_s", "s", "device time of a frame, first to last timestamp", &TimedTrial::frame_device_s},
    {"timing", "frame_rendered_s", "s", "wall time of a frame and its picture", &TimedTrial::frame_rendered_s, false,
     true},
    {"timing", "frame_cpu_s", "s", "CPU time of a frame, of all threads of the process", &TimedTrial::frame_cpu_s,
     false, true},
    {"timing", "stage_device_s", "s", "device time of a stage, from the profiled twin", &TimedTrial::stage_device_s,
     true},
    {"bandwidth", "read_B", "B", "bytes loaded by shaders, counted in a run of its own", &TimedTrial::stage_read_B,
     true},
    {"bandwidth", "write_B", "B", "bytes stored by shaders, counted in a run of its own", &TimedTrial::stage_write_B,
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
};

nlohmann::json to_json(const TimedTrial&);
nlohmann::json to_json(const std::vector<MetricSeries>&);
/// Time and positions of frame k of the pass.
nlohmann::json frame_to_json(const AccuracyPass&, std::size_t k);
nlohmann::json to_json(const std::vector<StoredGroup>&);

/// A run while it is measured: a sequence of CBOR items (RFC 8949, RFC 8742), each an object with one member. On a
/// device without HDF5 it stays the final form. First "header", then as they come "replay", "frame" (one item per frame
/// of the untimed pass, whose metrics and end follow as "accuracy" and "outcome"), "trial" (one item per trial), at
/// last "outcome". A later item replaces an earlier one of the same kind (for trials: of the same index); frame 0
/// begins the pass anew. Series of numbers are byte strings as memory holds them, little-endian.

/// Creates the file with its header, whole or not at all.
void create_part(const std::filesystem::path&, const RunHeader&);

/// Appends an item and, if `sync`, calls fsync (without it, the item is lost only if the machine fails). Throws Error
/// naming the file, and then leaves the file unchanged.
void append_to_part(const std::filesystem::path&, const char* kind, nlohmann::json body, bool sync = true);

/// Reads all complete items and ignores what follows them: a killed process leaves an incomplete item at the end.
/// `complete_B`: receives the length of the complete items. Throws Error naming the file if it has no header, or if a
/// complete item is not what it should be.
RunRecord read_part(const std::filesystem::path&, std::uintmax_t* complete_B = nullptr);

}  // namespace clothbench
