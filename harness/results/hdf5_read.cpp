#include <cmath>

#include "results/hdf5_handle.hpp"
#include "results/part_file.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

using h5::check;
using h5::Dims;
using h5::Id;
using nlohmann::json;

constexpr hsize_t kMostValues = hsize_t{1} << 31;

bool exists(hid_t at, const char* name) { return H5Lexists(at, name, H5P_DEFAULT) > 0; }

Dims dims_of(hid_t d) {
  const Id space(H5Dget_space(d), H5Sclose, "H5Dget_space");
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0) throw Error("a dataset without extent");
  Dims dims(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space, dims.data(), nullptr);
  return dims;
}

hsize_t product(const Dims& dims) {
  hsize_t n = 1;
  for (hsize_t d : dims) {
    if (d != 0 && n > kMostValues / d) throw Error("a dataset is larger than a run can be");
    n *= d;
  }
  return n;
}

template <class T>
std::vector<T> numbers(hid_t at, const char* name, hid_t type, Dims* shape = nullptr) {
  const Id d(H5Dopen2(at, name, H5P_DEFAULT), H5Dclose, std::string("opening ") + name);
  const Dims dims = dims_of(d);
  std::vector<T> values(product(dims));
  if (!values.empty())
    check(H5Dread(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), std::string("reading ") + name);
  if (shape != nullptr) *shape = dims;
  return values;
}

std::string take_text(char* text) {
  std::string out = text == nullptr ? "" : text;
  H5free_memory(text);
  return out;
}

void require_text(hid_t type) {
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) <= 0) throw Error("expected variable-length text");
}

/// A text, a number or a list of numbers: the types that write_hdf5 gives attributes.
json attribute(hid_t at, const std::string& name) {
  const std::string what = "attribute " + name;
  const Id a(H5Aopen(at, name.c_str(), H5P_DEFAULT), H5Aclose, what), stored(H5Aget_type(a), H5Tclose, "H5Aget_type"),
      space(H5Aget_space(a), H5Sclose, "H5Aget_space");
  const hssize_t n = H5Sget_simple_extent_npoints(space);
  if (H5Tget_class(stored) == H5T_STRING) {
    require_text(stored);
    if (n != 1) throw Error(what + ": expected one text");
    char* text = nullptr;
    check(H5Aread(a, h5::string_type(), &text), what);
    return take_text(text);
  }
  if (n < 0 || n > 64) throw Error(what + ": expected one number or a short list of numbers");
  std::vector<double> values(static_cast<std::size_t>(n));
  check(H5Aread(a, H5T_NATIVE_DOUBLE, values.data()), what);
  if (H5Sget_simple_extent_type(space) == H5S_SCALAR) return values.at(0);
  return values;
}

std::string text_dataset(hid_t at, const char* name) {
  const Id d(H5Dopen2(at, name, H5P_DEFAULT), H5Dclose, std::string("opening ") + name),
      stored(H5Dget_type(d), H5Tclose, "H5Dget_type"), type = h5::string_type();
  require_text(stored);
  if (product(dims_of(d)) != 1) throw Error(std::string(name) + ": expected one text");
  char* text = nullptr;
  check(H5Dread(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &text), std::string("reading ") + name);
  return take_text(text);
}

template <class Info>
herr_t collect(hid_t, const char* name, const Info*, void* out) {
  static_cast<std::vector<std::string>*>(out)->emplace_back(name);
  return 0;
}

json attributes(hid_t at) {
  std::vector<std::string> names;
  check(H5Aiterate2(at, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect<H5A_info_t>, &names), "listing attributes");
  json out = json::object();
  for (const std::string& name : names) out[name] = attribute(at, name);
  return out;
}
std::vector<std::string> link_names(hid_t group) {
  std::vector<std::string> names;
  check(H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect<H5L_info_t>, &names), "listing a group");
  return names;
}

Id open_group(hid_t file, const char* name) {
  return Id(H5Gopen2(file, name, H5P_DEFAULT), H5Gclose, std::string("group ") + name);
}

/// A stored count as int. Throws Error if it does not fit.
int whole(const json& stored, const char* name) {
  const auto v = stored.get<double>();
  if (!(std::abs(v) <= 2e9)) throw Error(std::string("attribute ") + name + ": expected a whole number");
  return static_cast<int>(v);
}

void read_scalars(hid_t file, RunRecord& r) {
  attributes(open_group(file, "summary")).get_to(r.summary);
  const json o = attributes(open_group(file, "outcome"));
  r.outcome = {o.at("status"),  o.at("class"),  whole(o.at("failed_frame"), "failed_frame"),
               o.at("message"), o.at("expect"), o.at("trajectory_sha256")};
}

void read_trials(hid_t file, RunRecord& r) {
  const Id timing = open_group(file, "timing"), bandwidth = open_group(file, "bandwidth");
  Dims dims;
  const auto wall = numbers<double>(timing, "frame_wall_s", H5T_NATIVE_DOUBLE, &dims);
  const auto index = numbers<std::int64_t>(timing, "trial", H5T_NATIVE_INT64);
  if (dims.size() != 2 || index.size() != dims[0]) throw Error("/timing/frame_wall_s: expected a row for each trial");
  const std::size_t trials = dims[0], frames = dims[1];
  r.trials.resize(trials);
  std::vector<std::size_t> length(trials, 0);  // frames of each trial without padding
  for (std::size_t t = 0; t < trials; ++t) {
    r.trials[t].index = static_cast<int>(index[t]);
    while (length[t] < frames && !std::isnan(wall[t * frames + length[t]])) ++length[t];
  }
  for (const TrialNumber& n : kTrialNumbers) {
    const auto values = numbers<double>(timing, n.name, H5T_NATIVE_DOUBLE);
    if (values.size() != trials) throw Error(std::string("/timing/") + n.name + ": expected a number for each trial");
    for (std::size_t t = 0; t < trials; ++t) r.trials[t].*n.value = values[t];
  }
  for (const TrialSeries& s : kTrialSeries) {
    const hid_t group = s.group == std::string("timing") ? timing : bandwidth;
    if (s.optional && !exists(group, s.name)) continue;
    const auto values = numbers<double>(group, s.name, H5T_NATIVE_DOUBLE);
    const std::size_t width = s.by_stage ? r.header.stages.size() : 1;
    if (values.size() != trials * frames * width)
      throw Error(std::string("/") + s.group + "/" + s.name + " differs in length from /timing/frame_wall_s");
    for (std::size_t t = 0; t < trials; ++t) {
      const auto from = values.begin() + static_cast<std::ptrdiff_t>(t * frames * width);
      std::vector<double>& out = r.trials[t].*s.values;
      out.assign(from, from + static_cast<std::ptrdiff_t>(length[t] * width));
      if (s.optional) std::erase_if(out, [](double v) { return std::isnan(v); });
    }
  }
}

/// Positions of these frames from the dataset (frame, vertex, xyz).
std::vector<float> positions_of(hid_t file, const std::vector<std::size_t>& frames, std::size_t vertices) {
  const Id d(H5Dopen2(file, "trajectory/position", H5P_DEFAULT), H5Dclose, "opening trajectory/position"),
      space(H5Dget_space(d), H5Sclose, "H5Dget_space");
  if (const Dims dims = dims_of(d); dims.size() != 3 || dims[0] <= frames.back() || dims[1] != vertices || dims[2] != 3)
    throw Error("trajectory/position: expected positions of all frames and vertices");
  std::vector<float> out(frames.size() * vertices * 3);
  const hsize_t count[3] = {1, vertices, 3};
  const Id memory = h5::space({1, vertices, 3});
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const hsize_t start[3] = {frames[k], 0, 0};
    check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, count, nullptr), "selecting a frame");
    check(H5Dread(d, H5T_NATIVE_FLOAT, memory, space, H5P_DEFAULT, &out[k * vertices * 3]), "reading a frame");
  }
  return out;
}

void read_accuracy(hid_t file, RunRecord& r, std::size_t stride) {
  const Id metrics = open_group(file, "metrics");
  AccuracyPass& a = r.accuracy;
  a.time_s = numbers<double>(metrics, "time_s", H5T_NATIVE_DOUBLE);
  for (const std::string& n : link_names(metrics)) {
    if (n == "time_s" || n == "frame") continue;
    const Id d(H5Dopen2(metrics, n.c_str(), H5P_DEFAULT), H5Dclose, "opening " + n);
    a.metrics.push_back(
        {n, attribute(d, "units"), attribute(d, "long_name"), numbers<double>(metrics, n.c_str(), H5T_NATIVE_DOUBLE)});
  }
  // Triangles of a grid follow from its size; a summary includes the triangles of a mesh.
  if (stride > 0 || r.header.scenario_json.find("\"mesh\"") != std::string::npos)
    for (std::int64_t v : numbers<std::int64_t>(file, "triangles", H5T_NATIVE_INT64))
      r.header.triangles.push_back(static_cast<std::uint32_t>(v));
  // A copy for another machine may lack the motion.
  if (stride == 0 || !exists(file, "trajectory")) return;
  if (stride == 1) {
    a.position = numbers<float>(file, "trajectory/position", H5T_NATIVE_FLOAT);
    return;
  }
  const std::vector<std::size_t> frames = every(a.time_s.size(), stride);
  if (!frames.empty()) a.position = positions_of(file, frames, r.header.vertices);
}

/// All attributes and datasets of a group, except dimension scales.
StoredGroup read_group(hid_t file, const std::string& path) {
  const Id group = open_group(file, path.c_str());
  StoredGroup g{path, attributes(group), {}};
  for (const std::string& name : link_names(group)) {
    const Id object(H5Oopen(group, name.c_str(), H5P_DEFAULT), H5Oclose, "opening " + name);
    // Only scales have a CLASS. H5DSis_scale frees memory twice if that attribute is damaged (HDF5 1.10.8).
    if (H5Iget_type(object) != H5I_DATASET || H5Aexists(object, "CLASS") > 0) continue;
    const Id type(H5Dget_type(object), H5Tclose, "H5Dget_type");
    StoredArray& a = g.arrays.emplace_back();
    a.name = name;
    a.integer = H5Tget_class(type) == H5T_INTEGER;
    Dims shape;
    a.values = numbers<double>(group, name.c_str(), H5T_NATIVE_DOUBLE, &shape);
    a.shape.assign(shape.begin(), shape.end());
  }
  return g;
}

/// Reads the group `path`, if the file has it, and its subgroups 0 to `count` - 1.
void read_groups(hid_t file, const std::string& path, std::vector<StoredGroup>& out) {
  if (!exists(file, path.c_str())) return;
  out.push_back(read_group(file, path));
  const auto count = out.back().attributes.at("count").get<double>();
  for (int k = 0; k < count; ++k) out.push_back(read_group(file, path + "/" + std::to_string(k)));
  if (const std::string grips = path + "/grips"; exists(file, grips.c_str())) out.push_back(read_group(file, grips));
}

}  // namespace

RunRecord read_hdf5(const std::filesystem::path& path, std::size_t stride) {
  h5::be_quiet();
  try {
    const Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "opening the file");
    if (attribute(file, "format") != "clothbench-run") throw Error("not a clothbench run (attribute format)");
    if (const int version = whole(attribute(file, "format_version"), "format_version"); version != 2)
      throw Error("format_version " + std::to_string(version) + "; this build reads 2");
    RunRecord r;
    json header = json_from(text_dataset(file, "header_json"));
    header["triangles"] = json::array();
    r.header = header_from_json(header);
    read_scalars(file, r);
    if (exists(file, "timing")) read_trials(file, r);
    if (exists(file, "metrics")) read_accuracy(file, r, stride);
    if (stride > 0)
      for (const char* part : {"cloth", "colliders"}) read_groups(file, part, r.replay);
    return r;
  } catch (const json::exception& e) {
    throw Error(path.string() + ": header_json or an attribute: " + what_without_text(e));
  } catch (const Error& e) {
    throw Error(path.string() + ": " + e.what());
  }
}

}  // namespace clothbench
