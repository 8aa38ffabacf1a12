#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace clothbench {

inline constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

/// Result of a run. `status` is one of ok, not_finite, diverged, device_lost, timed_out, crashed, unsupported, error,
/// over_budget (not run, because a setting with less work timed out).
struct Outcome {
  std::string status = "ok";
  std::string klass = "ok";  ///< outcome class F0 to F3, or ok
  int failed_frame = -1;
  std::string message;
  /// Result of the scene's `expect`: "pass"; "fail: " and the reason; "not measured"; "" if the scene has none.
  std::string expect = {};
  std::string trajectory_sha256 = {};  ///< hash of the motion that this result describes; set by the store
};

struct StageRecord {
  std::string name;
  std::vector<std::string> serves;
  int dispatches = 0;
};

/// Facts of a run that are known before its first frame. Serialised as JSON (results/part_file.hpp).
struct RunHeader {
  std::string scene, solver, setting;  ///< setting: short name such as "default" or "readback=blocking"
  nlohmann::json settings;             ///< with defaults filled in
  std::string scenario_json, scenario_sha256;
  std::vector<StageRecord> stages;
  nlohmann::json plan;         ///< `buffers` and `left_out` of the solver's Plan
  nlohmann::json environment;  ///< gpu, driver, cpu, compiler, commit, clock policy, ...
  std::uint32_t vertices = 0;
  std::vector<std::uint32_t> triangles;  ///< 3 per triangle
  double load_s = kMissing;              ///< wall time of load()
};

/// Series over the frames of one timed trial. Each vector has `frames()` entries, or frames x stages, row-major.
struct TimedTrial {
  int index = 0;
  std::vector<double> frame_wall_s, frame_device_s;
  std::vector<double> stage_device_s, stage_read_B, stage_write_B;  ///< (frame, stage)
  /// Mean wall time [s] of a frame when the trial is repeated without waiting for the end of each frame. NaN if not
  /// measured, or if the solver keeps at most one frame in flight.
  double pipelined_wall_s = kMissing;
  /// Wall times [s] of the first frames in a second run with rendering; empty unless requested.
  std::vector<double> frame_rendered_s = {};
  /// CPU time [s] of the process in each timed frame, summed over its threads (CLOCK_PROCESS_CPUTIME_ID). Empty for a
  /// GPU solver.
  std::vector<double> frame_cpu_s = {};
  /// System times [s since 1970 UTC] of the first timed frame's start and the last one's end, to match device logs.
  double start_unix_s = kMissing, end_unix_s = kMissing;
  double jobs = kMissing;  ///< concurrent clothbench jobs on the machine, this one included
  /// After the trial: clocks of the fastest core and the GPU, temperature of the hottest zone. Mean power during it.
  double cpu_clock_Hz = kMissing, gpu_clock_Hz = kMissing, temperature_C = kMissing, power_W = kMissing,
         gpu_power_W = kMissing;
  int frames() const { return static_cast<int>(frame_wall_s.size()); }
};

struct MetricSeries {
  std::string name, units, long_name;
  std::vector<double> values;  ///< one per stored frame, frame 0 = initial state
};

/// The untimed pass that yields positions and metrics.
struct AccuracyPass {
  std::vector<double> time_s;   ///< frames+1
  std::vector<float> position;  ///< (frames+1, vertices, 3)
  std::vector<MetricSeries> metrics;
};

/// A stored array that is not a metric series. Integers are exact in a double.
struct StoredArray {
  std::string name, units, long_name;
  std::vector<std::string> dims;     ///< names, slowest-varying first
  std::vector<std::uint64_t> shape;  ///< one size per name in `dims`
  bool integer = false;
  std::vector<double> values = {};
};

/// Arrays and attributes (numbers, strings, lists of numbers) of one group of the file, such as "colliders/0".
struct StoredGroup {
  std::string path;
  nlohmann::json attributes = nlohmann::json::object();
  std::vector<StoredArray> arrays;
};

/// One run: one scene x one solver x one setting. A result file holds one of these.
struct RunRecord {
  RunHeader header;
  std::vector<TimedTrial> trials;
  AccuracyPass accuracy;
  std::vector<StoredGroup> replay;  ///< motion of colliders and grips, from replay_of (results/store.hpp)
  Outcome outcome;
  std::map<std::string, double> summary;             ///< every scalar for tables; NaN = missing
  std::string file = {};                             ///< the file it was read from; empty if none
  std::vector<StoredGroup> samples = {};             ///< device readings during the run (DeviceSamples); not read back
  std::map<std::string, std::string> withheld = {};  ///< summary values that a report must not print, and why
};

}  // namespace clothbench
