// Layout: results/README.md.

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "base/files.hpp"
#include "results/hdf5_handle.hpp"
#include "results/part_file.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

using h5::Dims;
using h5::Id;

/// Creation properties without time stamps, so that equal runs give equal bytes.
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
hid_t type_of() {
  if constexpr (std::is_same_v<T, double>)
    return H5T_IEEE_F64LE;
  else if constexpr (std::is_same_v<T, float>)
    return H5T_IEEE_F32LE;
  else
    return H5T_STD_I64LE;
}

template <class T>
void number_attribute(hid_t at, const std::string& name, const std::vector<T>& values, bool scalar = true) {
  const Id space = h5::space(scalar ? Dims{} : Dims{values.size()});
  const Id a(H5Acreate2(at, name.c_str(), type_of<T>(), space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
             "attribute " + name);
  h5::check(H5Awrite(a, type_of<T>(), values.data()), "attribute " + name);
}

/// A number, a text or a list of numbers: the types of StoredGroup's attributes.
void json_attribute(hid_t at, const std::string& name, const nlohmann::json& value) {
  if (value.is_string())
    text_attribute(at, name, value.get<std::string>());
  else if (value.is_array())
    number_attribute(at, name, value.get<std::vector<double>>(), false);
  else
    number_attribute<double>(at, name, {value.get<double>()});
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
Id write_numbers(hid_t at, const std::string& name, const Dims& dims, const std::vector<T>& values, const Label& label,
                 const Dims& chunk = {}) {
  const Id properties = creation(H5P_DATASET_CREATE);
  // HDF5 has no empty chunks; a dataset without values needs no chunks.
  if (!chunk.empty() && !values.empty()) {
    h5::check(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()), "H5Pset_chunk");
    h5::check(H5Pset_shuffle(properties), "H5Pset_shuffle");
    h5::check(H5Pset_deflate(properties, 4), "H5Pset_deflate");
  }
  Id d = dataset(at, name, type_of<T>(), dims, label, properties);
  if (!values.empty())
    h5::check(H5Dwrite(d, type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "writing " + name);
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

/// Makes a dimension scale: a named one-dimensional dataset to which others attach.
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

/// Trials x frames (x stages), filled with NaN where a trial's series is shorter.
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
    text_attribute(file_, "format", "clothbench-run");
    number_attribute<std::int64_t>(file_, "format_version", {2});
    text_attribute(file_, "scene", r_.header.scene);
    text_attribute(file_, "solver", r_.header.solver);
    text_attribute(file_, "setting", r_.header.setting);
    nlohmann::json header = header_to_json(r_.header);
    header.erase("triangles");
    write_strings(file_, "header_json", {dump(header)}, {"1", "everything known before the first frame, as JSON"});
    scalars();
    if (!r_.trials.empty()) timing();
    for (const StoredGroup& g : r_.replay) stored(g);
    for (const StoredGroup& g : r_.samples) stored(g);
    if (!r_.accuracy.time_s.empty()) {
      metrics();
      trajectory();
    }
  }

 private:
  void scalars() {
    const Id summary = make_group(file_, "summary"), outcome = make_group(file_, "outcome");
    for (const auto& [key, value] : r_.summary) number_attribute<double>(summary, key, {value});
    text_attribute(outcome, "status", r_.outcome.status);
    text_attribute(outcome, "class", r_.outcome.klass);
    number_attribute<std::int64_t>(outcome, "failed_frame", {r_.outcome.failed_frame});
    text_attribute(outcome, "message", r_.outcome.message);
    text_attribute(outcome, "expect", r_.outcome.expect);
    text_attribute(outcome, "trajectory_sha256", trajectory_sha256(r_.accuracy));
  }

  void timing() {
    std::vector<std::string> names;
    for (const StageRecord& s : r_.header.stages) names.push_back(s.name);
    const std::size_t trials = r_.trials.size(), stages = names.size();
    std::vector<std::int64_t> indices;
    for (const TimedTrial& t : r_.trials) indices.push_back(t.index);
    for (const std::string group : {"timing", "bandwidth"}) {
      const Id g = make_group(file_, group);
      const Id trial = scale(write_numbers(g, "trial", {trials}, indices, {"1", "trial"}), "trial");
      const Id frame = index_scale(g, "frame", frames_, "frame within the trial");
      const Id stage = scale(write_strings(g, "stage", names, {"1", "stage of a frame"}), "stage");
      for (const TrialSeries& s : kTrialSeries) {
        const bool missing =
            std::all_of(r_.trials.begin(), r_.trials.end(), [&](const TimedTrial& t) { return (t.*s.values).empty(); });
        if (s.group != group || (s.optional && missing)) continue;
        const std::vector<double> values = padded(r_, frames_, s.by_stage ? stages : 1, s.values);
        const Label label{s.units, s.long_name};
        if (s.by_stage)
          attach(write_numbers(g, s.name, {trials, frames_, stages}, values, label, {1, frames_, stages}),
                 {trial, frame, stage});
        else
          attach(write_numbers(g, s.name, {trials, frames_}, values, label), {trial, frame});
      }
      if (group != "timing") continue;
      for (const TrialNumber& n : kTrialNumbers) {
        std::vector<double> values;
        for (const TimedTrial& t : r_.trials) values.push_back(t.*n.value);
        attach(write_numbers(g, n.name, {trials}, values, {n.units, n.long_name}), {trial});
      }
    }
  }

  /// Writes arrays unchanged, each with its dimensions; arrays of a group share dimensions by name.
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

  /// Writes the positions, and a view of each frame for the .xdmf file.
  void trajectory() {
    const Id g = make_group(file_, "trajectory"), frames = make_group(file_, "frames");
    const std::uint64_t steps = r_.accuracy.time_s.size(), points = r_.header.vertices;
    const Id time = scale(write_numbers(g, "time_s", {steps}, r_.accuracy.time_s, {"s", "time"}), "time_s");
    const Id vertex = index_scale(g, "vertex", points, "vertex, row by row of the grid");
    const Id xyz = scale(write_strings(g, "xyz", {"x", "y", "z"}, {"1", "axis; y is up"}), "xyz");
    attach(write_numbers(g, "position", {steps, points, 3}, r_.accuracy.position, {"m", "vertex positions"},
                         {1, points, 3}),
           {time, vertex, xyz});
    for (std::uint64_t k = 0; k < steps; ++k) {
      const Id properties = creation(H5P_DATASET_CREATE), target = h5::space({points, 3}),
               source = h5::space({steps, points, 3});
      const hsize_t start[3] = {k, 0, 0}, size[3] = {1, points, 3};
      h5::check(H5Sselect_hyperslab(source, H5S_SELECT_SET, start, nullptr, size, nullptr), "H5Sselect_hyperslab");
      h5::check(H5Pset_virtual(properties, target, ".", "/trajectory/position", source), "H5Pset_virtual");
      dataset(frames, fmt::format("{:06}", k), H5T_IEEE_F32LE, {points, 3}, {"m", "vertex positions of one frame"},
              properties);
    }
    const std::vector<std::int64_t> triangles(r_.header.triangles.begin(), r_.header.triangles.end());
    write_numbers(file_, "triangles", {triangles.size() / 3, 3}, triangles, {"1", "vertices of each triangle"});
  }

  hid_t file_;
  const RunRecord& r_;
  std::size_t frames_ = 0;
};

/// A mesh as an XDMF grid: paths of its triangles and vertices (`bytes` per number) in file `h5`.
std::string mesh(const std::string& name, const std::string& h5, const std::string& triangles_at, std::size_t triangles,
                 const std::string& positions_at, std::size_t vertices, int bytes, const std::string& time) {
  return fmt::format(
      "   <Grid Name=\"{0}\" GridType=\"Uniform\">\n{7}"
      "    <Topology TopologyType=\"Triangle\" NumberOfElements=\"{1}\">\n"
      "     <DataItem Dimensions=\"{1} 3\" NumberType=\"Int\" Precision=\"8\" Format=\"HDF\">{2}:{3}</DataItem>\n"
      "    </Topology>\n"
      "    <Geometry GeometryType=\"XYZ\">\n"
      "     <DataItem Dimensions=\"{4} 3\" NumberType=\"Float\" Precision=\"{5}\" Format=\"HDF\">{2}:{6}</DataItem>\n"
      "    </Geometry>\n"
      "   </Grid>\n",
      name, triangles, h5, triangles_at, vertices, bytes, positions_at, time);
}

/// Static meshes, such as the desk under the cloth. Moving objects are stored as motion, not as meshes.
std::string still_meshes(const RunRecord& record, const std::string& h5) {
  std::string out;
  for (const StoredGroup& g : record.replay) {
    std::size_t vertices = 0, triangles = 0;
    bool moves = false;
    for (const StoredArray& a : g.arrays) {
      if (a.name == "position_m") vertices = a.shape[0];
      if (a.name == "triangles") triangles = a.shape[0];
      moves = moves || a.name == "joint_matrix";
    }
    if (vertices > 0 && triangles > 0 && !moves)
      out += mesh(g.path, h5, "/" + g.path + "/triangles", triangles, "/" + g.path + "/position_m", vertices, 8, "");
  }
  return out;
}

}  // namespace

void write_hdf5(const std::filesystem::path& path, const RunRecord& record) {
  const std::filesystem::path temporary = temporary_name(path);
  h5::be_quiet();
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

void write_xdmf(const std::filesystem::path& path, const std::string& h5_name, const RunRecord& record) {
  const std::size_t triangles = record.header.triangles.size() / 3;
  const std::string still = still_meshes(record, h5_name);
  std::string out =
      "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"2.0\">\n <Domain>\n"
      "  <Grid Name=\"cloth\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (std::size_t k = 0; k < record.accuracy.time_s.size(); ++k) {
    const std::string time = fmt::format("    <Time Value=\"{:.9g}\"/>\n", record.accuracy.time_s[k]);
    const std::string positions = fmt::format("/frames/{:06}", k);
    // All of ParaView's readers find the static meshes only if every frame has them.
    if (still.empty())
      out += mesh(fmt::format("frame {}", k), h5_name, "/triangles", triangles, positions, record.header.vertices, 4,
                  time);
    else
      out += fmt::format("   <Grid Name=\"frame {}\" GridType=\"Collection\" CollectionType=\"Spatial\">\n", k) + time +
             mesh("cloth", h5_name, "/triangles", triangles, positions, record.header.vertices, 4, "") + still +
             "   </Grid>\n";
  }
  out += "  </Grid>\n </Domain>\n</Xdmf>\n";
  write_file_atomically(path, out);
}

}  // namespace clothbench
