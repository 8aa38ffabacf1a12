// Layout: results/README.md. VTKHDF: the temporal PolyData of VTK's file format documentation, version 2.0.
#include "results/hdf5_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "base/files.hpp"
#include "results/hdf5_handle.hpp"
#include "results/raw_file.hpp"
#include "results/trajectory.hpp"

namespace clothbench {
namespace {

using h5::Dims;
using h5::Id;

/// Creation properties without time stamps: the same run gives the same bytes.
Id creation(hid_t cls) {
  Id p(H5Pcreate(cls), H5Pclose, "H5Pcreate");
  h5::check(H5Pset_obj_track_times(p, false), "H5Pset_obj_track_times");
  return p;
}

Id make_group(hid_t at, const std::string& name) {
  Id properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "H5Pcreate");
  return Id(H5Gcreate2(at, name.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT), H5Gclose, "group " + name);
}

void text_attribute(hid_t at, const std::string& name, const std::string& value) {
  const Id type = h5::string_type(), space = h5::space({});
  const Id a(H5Acreate2(at, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, "attribute " + name);
  const char* text = value.c_str();
  h5::check(H5Awrite(a, type, &text), "attribute " + name);
}

template <class T>
void number_attribute(hid_t at, const std::string& name, hid_t file_type, hid_t memory_type,
                      const std::vector<T>& values, bool scalar) {
  const Id space = h5::space(scalar ? Dims{} : Dims{values.size()});
  const Id a(H5Acreate2(at, name.c_str(), file_type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, "attribute " + name);
  h5::check(H5Awrite(a, memory_type, values.data()), "attribute " + name);
}

void number_attribute(hid_t at, const std::string& name, double v) {
  number_attribute<double>(at, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {v}, true);
}
/// A number, a text, a list of numbers: what StoredGroup's attributes may be.
void json_attribute(hid_t at, const std::string& name, const nlohmann::json& value) {
  if (value.is_string()) return text_attribute(at, name, value.get<std::string>());
  const bool list = value.is_array();
  const auto numbers = list ? value.get<std::vector<double>>() : std::vector<double>{value.get<double>()};
  number_attribute(at, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, numbers, !list);
}
void integer_attribute(hid_t at, const std::string& name, std::int64_t v) {
  number_attribute<std::int64_t>(at, name, H5T_STD_I64LE, H5T_NATIVE_INT64, {v}, true);
}

struct Label {
  std::string units, long_name;
};

Id dataset(hid_t at, const std::string& name, hid_t type, const Dims& dims, const Label& label, hid_t properties) {
  const Id space = h5::space(dims);
  Id d(H5Dcreate2(at, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose, "dataset " + name);
  text_attribute(d, "units", label.units);
  text_attribute(d, "long_name", label.long_name);
  return d;
}

template <class T>
struct Types;
template <>
struct Types<double> {
  static hid_t file() { return H5T_IEEE_F64LE; }
  static hid_t memory() { return H5T_NATIVE_DOUBLE; }
};
template <>
struct Types<float> {
  static hid_t file() { return H5T_IEEE_F32LE; }
  static hid_t memory() { return H5T_NATIVE_FLOAT; }
};
template <>
struct Types<std::int64_t> {
  static hid_t file() { return H5T_STD_I64LE; }
  static hid_t memory() { return H5T_NATIVE_INT64; }
};

template <class T>
Id write_numbers(hid_t at, const std::string& name, const Dims& dims, const std::vector<T>& values, const Label& label,
                 const Dims& chunk = {}) {
  const Id properties = creation(H5P_DATASET_CREATE);
  // HDF5 has no empty chunks; a dataset without values needs none.
  if (!chunk.empty() && !values.empty()) {
    h5::check(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()), "H5Pset_chunk");
    h5::check(H5Pset_shuffle(properties), "H5Pset_shuffle");
    h5::check(H5Pset_deflate(properties, 4), "H5Pset_deflate");
  }
  Id d = dataset(at, name, Types<T>::file(), dims, label, properties);
  if (!values.empty())
    h5::check(H5Dwrite(d, Types<T>::memory(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "writing " + name);
  return d;
}

Id write_strings(hid_t at, const std::string& name, const std::vector<std::string>& values, const Label& label) {
  const Id properties = creation(H5P_DATASET_CREATE), type = h5::string_type();
  Id d = dataset(at, name, type, {values.size()}, label, properties);
  std::vector<const char*> pointers;
  for (const std::string& v : values) pointers.push_back(v.c_str());
  if (!values.empty()) h5::check(H5Dwrite(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()), "writing " + name);
  return d;
}

/// A dimension: a one-dimensional dataset of its own name that others attach to.
Id scale(Id d, const std::string& name) {
  h5::check(H5DSset_scale(d, name.c_str()), "scale " + name);
  return d;
}

Id index_scale(hid_t at, const std::string& name, std::size_t count, const std::string& long_name,
               std::int64_t first = 0) {
  std::vector<std::int64_t> values(count);
  std::iota(values.begin(), values.end(), first);
  return scale(write_numbers(at, name, {count}, values, {"1", long_name}), name);
}

void attach(hid_t d, std::initializer_list<hid_t> scales) {
  unsigned k = 0;
  for (hid_t s : scales) h5::check(H5DSattach_scale(d, s, k++), "attaching a dimension");
}

/// Trials x frames (x stages) from series that may be shorter; missing = NaN.
std::vector<double> padded(const RunRecord& r, std::size_t frames, std::size_t stages,
                           std::vector<double> TimedTrial::*series) {
  std::vector<double> out(r.trials.size() * frames * stages, kMissing);
  for (std::size_t t = 0; t < r.trials.size(); ++t) {
    const std::vector<double>& v = r.trials[t].*series;
    std::copy(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(std::min(v.size(), frames * stages)),
              out.begin() + static_cast<std::ptrdiff_t>(t * frames * stages));
  }
  return out;
}

class Writer {
 public:
  Writer(hid_t file, const RunRecord& record) : file_(file), r_(record) {
    for (const TimedTrial& t : r_.trials) frames_ = std::max(frames_, t.frame_wall_s.size());
  }

  void write() {
    root_attributes();
    write_strings(file_, "header_json", {header_text()}, {"1", "everything known before the first frame, as JSON"});
    scalars();
    if (!r_.trials.empty()) timing();
    for (const StoredGroup& g : r_.replay) stored(g);
    for (const StoredGroup& g : r_.samples) stored(g);
    if (!r_.accuracy.time_s.empty()) {
      metrics();
      vtkhdf();
      frames();
      trajectory();
    }
  }

 private:
  std::string header_text() const {
    nlohmann::json j = header_to_json(r_.header);
    j.erase("triangles");
    return j.dump();
  }

  void root_attributes() {
    const RunHeader& h = r_.header;
    const nlohmann::json& e = h.environment;
    const auto from_environment = [&](const char* key) {
      const nlohmann::json v = e.value(key, nlohmann::json(""));
      return v.is_string() ? v.get<std::string>() : v.dump();
    };
    text_attribute(file_, "format", "clothbench-run");
    integer_attribute(file_, "format_version", 1);
    text_attribute(file_, "scene", h.scene);
    text_attribute(file_, "solver", h.solver);
    text_attribute(file_, "setting", h.setting);
    text_attribute(file_, "settings_json", h.settings.dump());
    text_attribute(file_, "scenario_json", h.scenario_json);
    text_attribute(file_, "scenario_sha256", h.scenario_sha256);
    for (const char* key : {"created", "git_commit", "git_dirty", "source_sha256", "build_type", "gpu", "driver",
                            "gpu_is_software", "cpu", "shader_compiler", "clock_policy", "protocol", "assets", "seed"})
      text_attribute(file_, key, from_environment(key));
  }

  void scalars() {
    const Id summary = make_group(file_, "summary"), outcome = make_group(file_, "outcome"),
             environment = make_group(file_, "environment");
    for (const auto& [key, value] : r_.summary) number_attribute(summary, key, value);
    text_attribute(outcome, "status", r_.outcome.status);
    text_attribute(outcome, "class", r_.outcome.klass);
    integer_attribute(outcome, "failed_frame", r_.outcome.failed_frame);
    text_attribute(outcome, "message", r_.outcome.message);
    text_attribute(outcome, "expect", r_.outcome.expect);
    text_attribute(outcome, "trajectory_sha256", trajectory_sha256(r_.accuracy));
    for (const auto& [key, value] : r_.header.environment.items())
      if (!value.is_structured())
        text_attribute(environment, key, value.is_string() ? value.get<std::string>() : value.dump());
  }

  void timing() {
    std::vector<std::string> names;
    for (const StageRecord& s : r_.header.stages) names.push_back(s.name);
    const std::size_t trials = r_.trials.size(), stages = names.size();
    for (const bool bandwidth : {false, true}) {
      const Id g = make_group(file_, bandwidth ? "bandwidth" : "timing");
      std::vector<std::int64_t> indices;
      for (const TimedTrial& t : r_.trials) indices.push_back(t.index);
      const Id trial = scale(write_numbers(g, "trial", {trials}, indices, {"1", "trial"}), "trial");
      const Id frame = index_scale(g, "frame", frames_, "frame within the trial");
      const Id stage = scale(write_strings(g, "stage", names, {"1", "stage of a frame"}), "stage");
      const auto by_frame = [&](const char* name, std::vector<double> TimedTrial::*series, const Label& label) {
        attach(write_numbers(g, name, {trials, frames_}, padded(r_, frames_, 1, series), label), {trial, frame});
      };
      const auto by_stage = [&](const char* name, std::vector<double> TimedTrial::*series, const Label& label) {
        attach(write_numbers(g, name, {trials, frames_, stages}, padded(r_, frames_, stages, series), label,
                             {1, frames_, stages}),
               {trial, frame, stage});
      };
      if (bandwidth) {
        by_stage("read_B", &TimedTrial::stage_read_B,
                 {"B", "bytes loaded by shaders, computed from the scene and the kernels"});
        by_stage("write_B", &TimedTrial::stage_write_B,
                 {"B", "bytes stored by shaders, computed from the scene and the kernels"});
        for (const StageRecord& s : r_.header.stages) text_attribute(g, "bytes." + s.name, s.bytes);
      } else {
        by_frame("frame_wall_s", &TimedTrial::frame_wall_s, {"s", "wall time of a frame"});
        by_frame("frame_device_s", &TimedTrial::frame_device_s,
                 {"s", "device time of a frame, first to last timestamp"});
        const auto by_frame_if_any = [&](const char* name, std::vector<double> TimedTrial::*series,
                                         const char* long_name) {
          if (std::any_of(r_.trials.begin(), r_.trials.end(),
                          [&](const TimedTrial& t) { return !(t.*series).empty(); }))
            by_frame(name, series, {"s", long_name});
        };
        by_frame_if_any("frame_rendered_s", &TimedTrial::frame_rendered_s, "wall time of a frame and its picture");
        by_frame_if_any("frame_cpu_s", &TimedTrial::frame_cpu_s, "CPU time of a frame, of all threads of the process");
        const auto by_trial = [&](const char* name, double TimedTrial::*value, const Label& label) {
          std::vector<double> values;
          for (const TimedTrial& t : r_.trials) values.push_back(t.*value);
          attach(write_numbers(g, name, {trials}, values, label), {trial});
        };
        by_trial("pipelined_wall_s", &TimedTrial::pipelined_wall_s, {"s", "mean wall time of a frame, two in flight"});
        by_trial("trial_start_unix_s", &TimedTrial::start_unix_s,
                 {"s", "when the trial's first timed frame began, since 1970 UTC"});
        by_trial("trial_end_unix_s", &TimedTrial::end_unix_s,
                 {"s", "when the trial's last timed frame ended, since 1970 UTC"});
        by_trial("jobs", &TimedTrial::jobs,
                 {"1", "clothbench jobs on the machine during the trial, this one included"});
        by_stage("stage_device_s", &TimedTrial::stage_device_s,
                 {"s", "device time of a stage, from the profiled twin"});
        number_attribute(g, "load_s", r_.header.load_s);
        for (const StageRecord& s : r_.header.stages) integer_attribute(g, "dispatches." + s.name, s.dispatches);
      }
    }
  }

  /// Arrays as they come, each with its dimensions; those of a group share them by name.
  void stored(const StoredGroup& group) {
    const Id g = make_group(file_, group.path);
    for (const auto& [name, value] : group.attributes.items()) json_attribute(g, name, value);
    std::map<std::string, Id> scales;
    for (const StoredArray& a : group.arrays) {
      for (std::size_t k = 0; k < a.dims.size(); ++k)
        if (!scales.contains(a.dims[k])) scales.emplace(a.dims[k], index_scale(g, a.dims[k], a.shape[k], a.dims[k]));
      const Label label{a.units, a.long_name};
      const Dims dims(a.shape.begin(), a.shape.end());
      const Id d = a.integer ? write_numbers(g, a.name, dims,
                                             std::vector<std::int64_t>(a.values.begin(), a.values.end()), label, dims)
                             : write_numbers(g, a.name, dims, a.values, label, dims);
      for (std::size_t k = 0; k < a.dims.size(); ++k)
        h5::check(H5DSattach_scale(d, scales.at(a.dims[k]), static_cast<unsigned>(k)), "attaching a dimension");
    }
  }

  void metrics() {
    const Id g = make_group(file_, "metrics");
    const std::size_t count = r_.accuracy.time_s.size();
    const Id frame = index_scale(g, "frame", count, "frame; 0 is the initial state");
    attach(write_numbers(g, "time_s", {count}, r_.accuracy.time_s, {"s", "time"}), {frame});
    for (const MetricSeries& m : r_.accuracy.metrics) {
      const Id d = write_numbers(g, m.name, {count}, m.values, {m.units, m.long_name});
      attach(d, {frame});
    }
  }

  /// One kind of cell of the PolyData; an empty kind has no runs and Offsets = {0}.
  void runs(hid_t g, const char* name, std::size_t steps, const std::vector<std::int64_t>& connectivity,
            std::int64_t corners) {
    const Id c = make_group(g, name);
    const std::int64_t count = connectivity.empty() ? 0 : static_cast<std::int64_t>(connectivity.size()) / corners;
    std::vector<std::int64_t> offsets;
    for (std::int64_t k = 0; k <= count; ++k) offsets.push_back(k * corners);
    const auto ids = static_cast<std::int64_t>(connectivity.size());
    write_numbers(c, "NumberOfCells", {steps}, std::vector<std::int64_t>(steps, count), {"1", "cells of each frame"});
    write_numbers(c, "NumberOfConnectivityIds", {steps}, std::vector<std::int64_t>(steps, ids),
                  {"1", "corners of all cells of each frame"});
    write_numbers(c, "Offsets", {offsets.size()}, offsets, {"1", "where each cell begins in Connectivity"});
    write_numbers(c, "Connectivity", {connectivity.size()}, connectivity, {"1", "points of each cell"});
  }

  void vtkhdf() {
    const Id g = make_group(file_, "VTKHDF");
    const std::size_t steps = r_.accuracy.time_s.size();
    const std::uint64_t points = r_.header.vertices;
    number_attribute<std::int64_t>(g, "Version", H5T_STD_I64LE, H5T_NATIVE_INT64, {2, 0}, false);
    {
      const Id type(H5Tcopy(H5T_C_S1), H5Tclose, "H5Tcopy"), space = h5::space({});
      h5::check(H5Tset_size(type, 8), "H5Tset_size");
      h5::check(H5Tset_strpad(type, H5T_STR_NULLPAD), "H5Tset_strpad");
      const Id a(H5Acreate2(g, "Type", type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, "attribute Type");
      h5::check(H5Awrite(a, type, "PolyData"), "attribute Type");
    }
    write_numbers(g, "NumberOfPoints", {steps}, std::vector<std::int64_t>(steps, static_cast<std::int64_t>(points)),
                  {"1", "points of each frame"});
    write_numbers(g, "Points", {steps * points, 3}, r_.accuracy.position, {"m", "vertex positions, frame after frame"},
                  {points, 3});
    for (const char* kind : {"Vertices", "Lines", "Strips"}) runs(g, kind, steps, {}, 1);
    runs(g, "Polygons", steps, {r_.header.triangles.begin(), r_.header.triangles.end()}, 3);
    const Id s = make_group(g, "Steps");
    integer_attribute(s, "NSteps", static_cast<std::int64_t>(steps));
    std::vector<std::int64_t> part(steps), offset(steps);
    for (std::size_t k = 0; k < steps; ++k) {
      part[k] = static_cast<std::int64_t>(k);
      offset[k] = static_cast<std::int64_t>(k * points);
    }
    write_numbers(s, "Values", {steps}, r_.accuracy.time_s, {"s", "time"});
    write_numbers(s, "PartOffsets", {steps}, part, {"1", "first part of each frame"});
    write_numbers(s, "NumberOfParts", {steps}, std::vector<std::int64_t>(steps, 1), {"1", "parts of each frame"});
    write_numbers(s, "PointOffsets", {steps}, offset, {"1", "first point of each frame"});
    // The topology is stored once: every step starts at run 0.
    for (const char* name : {"CellOffsets", "ConnectivityIdOffsets"})
      write_numbers(s, name, {steps, 4}, std::vector<std::int64_t>(4 * steps, 0), {"1", "first of each kind of cell"});
    make_group(s, "PointDataOffsets");
  }

  /// A dataset that is a view of `count` rows of /VTKHDF/Points from `first` on.
  Id view(hid_t at, const std::string& name, const Dims& dims, std::uint64_t first, std::uint64_t count,
          const Label& label) {
    const std::uint64_t rows = r_.accuracy.position.size() / 3;
    const Id properties = creation(H5P_DATASET_CREATE), target = h5::space(dims), source = h5::space({rows, 3});
    const hsize_t start[2] = {first, 0}, size[2] = {count, 3};
    h5::check(H5Sselect_hyperslab(source, H5S_SELECT_SET, start, nullptr, size, nullptr), "H5Sselect_hyperslab");
    h5::check(H5Pset_virtual(properties, target, ".", "/VTKHDF/Points", source), "H5Pset_virtual");
    return dataset(at, name, H5T_IEEE_F32LE, dims, label, properties);
  }

  void frames() {
    const Id g = make_group(file_, "frames");
    const std::uint64_t points = r_.header.vertices;
    for (std::size_t k = 0; k < r_.accuracy.time_s.size(); ++k)
      view(g, fmt::format("{:06}", k), {points, 3}, k * points, points, {"m", "vertex positions of one frame"});
    std::vector<std::int64_t> triangles(r_.header.triangles.begin(), r_.header.triangles.end());
    write_numbers(file_, "triangles", {triangles.size() / 3, 3}, triangles, {"1", "vertices of each triangle"});
  }

  void trajectory() {
    const Id g = make_group(file_, "trajectory");
    const std::size_t steps = r_.accuracy.time_s.size();
    const std::uint64_t points = r_.header.vertices;
    const Id time = scale(write_numbers(g, "time_s", {steps}, r_.accuracy.time_s, {"s", "time"}), "time_s");
    const Id vertex = index_scale(g, "vertex", points, "vertex, row after row of the grid");
    const Id xyz = scale(write_strings(g, "xyz", {"x", "y", "z"}, {"1", "axis; y is up"}), "xyz");
    attach(view(g, "position", {steps, points, 3}, 0, steps * points, {"m", "vertex positions"}), {time, vertex, xyz});
  }

  hid_t file_;
  const RunRecord& r_;
  std::size_t frames_ = 0;
};

}  // namespace

void write_hdf5(const std::filesystem::path& path, const RunRecord& record) {
  const std::filesystem::path temporary = temporary_name(path);
  const h5::Quiet quiet;
  try {
    const Id properties = creation(H5P_FILE_CREATE), access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "H5Pcreate");
    const Id file(H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, properties, access), H5Fclose, "creating the file");
    Writer(file, record).write();
    h5::check(H5Fflush(file, H5F_SCOPE_GLOBAL), "flushing the file");
  } catch (const Error& e) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw Error(path.string() + ": " + e.what(), ExitCode::CheckFailed);
  }
  publish(temporary, path);
}

}  // namespace clothbench
