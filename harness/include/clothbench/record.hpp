#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace clothbench {

inline constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

/// How a run ended. `status` is one of ok, not_finite, diverged, device_lost, timed_out, crashed, unsupported,
/// over_budget (not run: settings of less work had used up its solver's time), error.
struct Outcome {
  std::string status = "ok";
  std::string klass = "ok";  ///< F0..F8 or ok
  int failed_frame = -1;
  std::string message;
  /// Of the scene's `expect`: "pass", "fail: " and what, "not measured", or "" if the scene expects nothing.
  std::string expect = {};
};

struct StageRecord {
  std::string name;
  std::vector<std::string> serves;
  int dispatches = 0;
  /// What its bytes are: "computed", "at least" (what it reads is a lower bound), or "" where it has none or the file
  /// is older than this distinction.
  std::string bytes = {};
};

/// What is known of a run before its first frame. Serialised as JSON (`to_json`) in raw files and as attributes in
/// HDF5.
struct RunHeader {
  std::string scene, solver, setting;  ///< setting: short name such as "default" or "readback=blocking"
  nlohmann::json settings;             ///< complete
  std::string scenario_json, scenario_sha256;
  std::vector<StageRecord> stages;
  nlohmann::json plan;         ///< buffers, left out
  nlohmann::json environment;  ///< gpu, driver, cpu, compiler, commit, clock policy, ...
  std::uint32_t vertices = 0;
  std::vector<std::uint32_t> triangles;  ///< 3 per triangle
  double load_s = kMissing;              ///< wall time of load()
};

/// Series over the frames of one timed trial; the sizes of all vectors agree: frames, or frames*stages row-major.
struct TimedTrial {
  int index = 0;
  std::vector<double> frame_wall_s, frame_device_s;
  std::vector<double> stage_device_s, stage_read_B, stage_write_B;  ///< (frame, stage)
  /// Mean wall time of a frame when the same frames are run again without waiting for each; NaN where the solver keeps
  /// no more than one in flight, or that was not measured.
  double pipelined_wall_s = kMissing;
  /// Wall times of its first frames run again, each with its picture drawn; empty unless asked for.
  std::vector<double> frame_rendered_s = {};
  /// When its first timed frame began and its last ended, by the machine's clock [s since 1970 UTC]: what samples that
  /// others took meanwhile are matched by.
  double start_unix_s = kMissing, end_unix_s = kMissing;
  double jobs = kMissing;  ///< clothbench jobs on the machine meanwhile, this one included; NaN in older files
  int frames() const { return static_cast<int>(frame_wall_s.size()); }
};

struct MetricSeries {
  std::string name, units, long_name;
  std::vector<double> values;  ///< one per stored frame, frame 0 = initial state
  int version = 1;             ///< of the metric's rule
};

/// The untimed pass that positions and metrics come from.
struct AccuracyPass {
  std::vector<double> time_s;   ///< frames+1
  std::vector<float> position;  ///< (frames+1, vertices, 3)
  std::vector<MetricSeries> metrics;
};

/// An array beside the series. Integers are exact in a double.
struct StoredArray {
  std::string name, units, long_name;
  std::vector<std::string> dims;     ///< names, slowest first
  std::vector<std::uint64_t> shape;  ///< as many
  bool integer = false;
  std::vector<double> values;
};

/// Arrays and attributes (numbers, texts, lists of numbers) at one place of the file, such as "colliders/0".
struct StoredGroup {
  std::string path;
  nlohmann::json attributes = nlohmann::json::object();
  std::vector<StoredArray> arrays;
};

/// One run: one scene x one solver x one setting. What a result file holds.
struct RunRecord {
  RunHeader header;
  std::vector<TimedTrial> trials;
  AccuracyPass accuracy;
  std::vector<StoredGroup> replay;  ///< colliders and grips with their motion; see results/replay.hpp
  Outcome outcome;
  std::map<std::string, double> summary;  ///< every scalar a table prints; NaN = missing
  std::string file = {};                  ///< where a report read it; empty: nowhere
  std::vector<StoredGroup> samples =
      {};  ///< what the device reported meanwhile (results/device_samples.hpp); not read back
  std::map<std::string, std::string> withheld =
      {};  ///< summary values that a report must not print, and why (report/withheld.hpp)
};

}  // namespace clothbench
