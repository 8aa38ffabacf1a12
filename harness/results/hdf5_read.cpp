#include <algorithm>
#include <cmath>

#include "base/json_text.hpp"
#include "results/hdf5_file.hpp"
#include "results/hdf5_handle.hpp"
#include "results/hdf5_values.hpp"
#include "results/raw_file.hpp"

namespace clothbench {
namespace {

using h5::Dims;
using h5::exists;
using h5::Id;
using h5::number_attribute;
using h5::numbers;
using h5::text_attribute;
using h5::text_dataset;

Id open_group(hid_t file, const char* name) {
  return Id(H5Gopen2(file, name, H5P_DEFAULT), H5Gclose, std::string("group ") + name);
}

/// An attribute that counts something. Throws Error if no int can hold it.
int whole_attribute(hid_t object, const char* name) {
  const double v = number_attribute(object, name);
  if (!(std::abs(v) <= 2e9)) throw Error(std::string("attribute ") + name + ": expected a whole number");
  return static_cast<int>(v);
}

void read_scalars(hid_t file, RunRecord& r) {
  const Id summary = open_group(file, "summary"), outcome = open_group(file, "outcome");
  for (const std::string& n : h5::attribute_names(summary)) r.summary[n] = number_attribute(summary, n.c_str());
  r.outcome = {text_attribute(outcome, "status"), text_attribute(outcome, "class"),
               whole_attribute(outcome, "failed_frame"), text_attribute(outcome, "message"),
               text_attribute(outcome, "expect")};
}

void read_trials(hid_t file, RunRecord& r) {
  const Id timing = open_group(file, "timing"), bandwidth = open_group(file, "bandwidth");
  Dims shape;
  const auto wall = numbers<double>(timing, "frame_wall_s", H5T_NATIVE_DOUBLE, &shape);
  const auto device = numbers<double>(timing, "frame_device_s", H5T_NATIVE_DOUBLE);
  const auto stage = numbers<double>(timing, "stage_device_s", H5T_NATIVE_DOUBLE);
  const auto read = numbers<double>(bandwidth, "read_B", H5T_NATIVE_DOUBLE),
             write = numbers<double>(bandwidth, "write_B", H5T_NATIVE_DOUBLE);
  const auto index = numbers<std::int64_t>(timing, "trial", H5T_NATIVE_INT64);
  const auto by_trial = [&](const char* name) {
    auto v = numbers<double>(timing, name, H5T_NATIVE_DOUBLE);
    if (v.size() != index.size())
      throw Error(std::string("/timing/") + name + " has another length than /timing/trial");
    return v;
  };
  const auto pipelined = by_trial("pipelined_wall_s"), start = by_trial("trial_start_unix_s"),
             end = by_trial("trial_end_unix_s"), jobs = by_trial("jobs");
  const auto by_frame = [&](const char* name) {  // only if they were measured
    return exists(timing, name) ? numbers<double>(timing, name, H5T_NATIVE_DOUBLE)
                                : std::vector<double>(wall.size(), kMissing);
  };
  const auto rendered = by_frame("frame_rendered_s"), cpu = by_frame("frame_cpu_s");
  const std::size_t stages = r.header.stages.size();
  if (shape.size() != 2 || index.size() != shape[0] || device.size() != wall.size() || rendered.size() != wall.size() ||
      cpu.size() != wall.size() || stage.size() != wall.size() * stages || read.size() != stage.size() ||
      write.size() != stage.size())
    throw Error("/timing and /bandwidth have different lengths");
  for (std::size_t t = 0; t < shape[0]; ++t) {
    TimedTrial trial;
    trial.index = static_cast<int>(index[t]);
    trial.pipelined_wall_s = pipelined[t];
    trial.start_unix_s = start[t];
    trial.end_unix_s = end[t];
    trial.jobs = jobs[t];
    for (std::size_t k = t * shape[1]; k < (t + 1) * shape[1]; ++k) {
      if (std::isnan(wall[k])) break;  // padding of a shorter trial
      trial.frame_wall_s.push_back(wall[k]);
      trial.frame_device_s.push_back(device[k]);
      if (!std::isnan(rendered[k])) trial.frame_rendered_s.push_back(rendered[k]);
      if (!std::isnan(cpu[k])) trial.frame_cpu_s.push_back(cpu[k]);
      const auto append = [&](std::vector<double>& to, const std::vector<double>& from) {
        to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(k * stages),
                  from.begin() + static_cast<std::ptrdiff_t>((k + 1) * stages));
      };
      append(trial.stage_device_s, stage);
      append(trial.stage_read_B, read);
      append(trial.stage_write_B, write);
    }
    r.trials.push_back(std::move(trial));
  }
}

void read_accuracy(hid_t file, RunRecord& r, bool with_trajectory) {
  const Id metrics = open_group(file, "metrics");
  r.accuracy.time_s = numbers<double>(metrics, "time_s", H5T_NATIVE_DOUBLE);
  // A copy for another machine may lack the motion.
  if (with_trajectory && h5::exists(file, "VTKHDF"))
    r.accuracy.position = numbers<float>(file, "VTKHDF/Points", H5T_NATIVE_FLOAT);
  // A grid's follow from its size; a summary has those of a mesh.
  if (with_trajectory || r.header.scenario_json.find("\"mesh\"") != std::string::npos)
    for (std::int64_t v : numbers<std::int64_t>(file, "triangles", H5T_NATIVE_INT64))
      r.header.triangles.push_back(static_cast<std::uint32_t>(v));
  for (const std::string& n : h5::link_names(metrics)) {
    if (n == "time_s" || n == "frame") continue;
    const Id d(H5Dopen2(metrics, n.c_str(), H5P_DEFAULT), H5Dclose, "opening " + n);
    r.accuracy.metrics.push_back({n, text_attribute(d, "units"), text_attribute(d, "long_name"),
                                  numbers<double>(metrics, n.c_str(), H5T_NATIVE_DOUBLE)});
  }
}

}  // namespace

std::string read_hdf5_trajectory_sha256(const std::filesystem::path& path) {
  const h5::Quiet quiet;
  try {
    const Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "opening the file");
    const Id outcome = open_group(file, "outcome");
    return H5Aexists(outcome, "trajectory_sha256") > 0 ? text_attribute(outcome, "trajectory_sha256") : "";
  } catch (const Error& e) {
    throw Error(path.string() + ": " + e.what());
  }
}

RunRecord read_hdf5(const std::filesystem::path& path, bool with_trajectory) {
  const h5::Quiet quiet;
  try {
    const Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "opening the file");
    if (text_attribute(file, "format") != "clothbench-run") throw Error("not a clothbench run (attribute format)");
    if (const int version = whole_attribute(file, "format_version"); version != 1)
      throw Error("format_version " + std::to_string(version) + "; this build reads 1");
    RunRecord r;
    nlohmann::json header = nlohmann::json::parse(text_dataset(file, "header_json"));
    header["triangles"] = nlohmann::json::array();
    r.header = header_from_json(header);
    read_scalars(file, r);
    if (exists(file, "timing")) read_trials(file, r);
    if (exists(file, "metrics")) read_accuracy(file, r, with_trajectory);
    return r;
  } catch (const nlohmann::json::exception& e) {
    throw Error(path.string() + ": header_json: " + what_without_text(e));
  } catch (const Error& e) {
    throw Error(path.string() + ": " + e.what());
  }
}

}  // namespace clothbench
