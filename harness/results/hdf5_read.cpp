#include <algorithm>
#include <cmath>

#include "results/hdf5_file.hpp"
#include "results/hdf5_handle.hpp"
#include "results/raw_file.hpp"

namespace clothbench {
namespace {

using h5::Dims;
using h5::Id;

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
    if (d != 0 && n > kMostValues / d) throw Error("a dataset is absurdly large");
    n *= d;
  }
  return n;
}

template <class T>
std::vector<T> numbers(hid_t at, const char* name, hid_t type, Dims* shape = nullptr) {
  const Id d(H5Dopen2(at, name, H5P_DEFAULT), H5Dclose, std::string("opening ") + name);
  const Dims dims = dims_of(d);
  std::vector<T> values(product(dims));
  if (!values.empty()) h5::check(H5Dread(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), std::string("reading ") + name);
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

std::string text_attribute(hid_t at, const char* name) {
  const Id a(H5Aopen(at, name, H5P_DEFAULT), H5Aclose, std::string("attribute ") + name), stored(H5Aget_type(a), H5Tclose, "H5Aget_type"),
      type = h5::string_type();
  require_text(stored);
  char* text = nullptr;
  h5::check(H5Aread(a, type, &text), std::string("attribute ") + name);
  return take_text(text);
}

std::string text_dataset(hid_t at, const char* name) {
  const Id d(H5Dopen2(at, name, H5P_DEFAULT), H5Dclose, std::string("opening ") + name), stored(H5Dget_type(d), H5Tclose, "H5Dget_type"),
      type = h5::string_type();
  require_text(stored);
  if (product(dims_of(d)) != 1) throw Error(std::string(name) + ": expected one text");
  char* text = nullptr;
  h5::check(H5Dread(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &text), std::string("reading ") + name);
  return take_text(text);
}

double number_attribute(hid_t at, const char* name) {
  const Id a(H5Aopen(at, name, H5P_DEFAULT), H5Aclose, std::string("attribute ") + name), space(H5Aget_space(a), H5Sclose, "H5Aget_space");
  if (H5Sget_simple_extent_npoints(space) != 1) throw Error(std::string("attribute ") + name + ": expected one number");
  double v = kMissing;
  h5::check(H5Aread(a, H5T_NATIVE_DOUBLE, &v), std::string("attribute ") + name);
  return v;
}

herr_t collect_name(hid_t, const char* name, const H5A_info_t*, void* out) {
  static_cast<std::vector<std::string>*>(out)->emplace_back(name);
  return 0;
}

Id open_group(hid_t file, const char* name) { return Id(H5Gopen2(file, name, H5P_DEFAULT), H5Gclose, std::string("group ") + name); }

void read_scalars(hid_t file, CellRecord& r) {
  const Id summary = open_group(file, "summary"), outcome = open_group(file, "outcome");
  std::vector<std::string> names;
  h5::check(H5Aiterate2(summary, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect_name, &names), "listing /summary");
  for (const std::string& n : names) r.summary[n] = number_attribute(summary, n.c_str());
  r.outcome = {text_attribute(outcome, "status"), text_attribute(outcome, "class"), static_cast<int>(number_attribute(outcome, "failed_frame")),
               text_attribute(outcome, "message"),
               H5Aexists(outcome, "expect") > 0 ? text_attribute(outcome, "expect") : ""};
}

void read_trials(hid_t file, CellRecord& r) {
  const Id timing = open_group(file, "timing"), bandwidth = open_group(file, "bandwidth");
  Dims shape;
  const auto wall = numbers<double>(timing, "frame_wall_s", H5T_NATIVE_DOUBLE, &shape);
  const auto device = numbers<double>(timing, "frame_device_s", H5T_NATIVE_DOUBLE);
  const auto stage = numbers<double>(timing, "stage_device_s", H5T_NATIVE_DOUBLE);
  const auto read = numbers<double>(bandwidth, "read_B", H5T_NATIVE_DOUBLE), write = numbers<double>(bandwidth, "write_B", H5T_NATIVE_DOUBLE);
  const auto index = numbers<std::int64_t>(timing, "trial", H5T_NATIVE_INT64);
  const auto pipelined = exists(timing, "pipelined_wall_s") ? numbers<double>(timing, "pipelined_wall_s", H5T_NATIVE_DOUBLE)
                                                            : std::vector<double>(index.size(), kMissing);
  const std::size_t stages = r.header.stages.size();
  if (pipelined.size() != index.size()) throw Error("/timing/pipelined_wall_s does not fit /timing/trial");
  if (shape.size() != 2 || index.size() != shape[0] || device.size() != wall.size() || stage.size() != wall.size() * stages ||
      read.size() != stage.size() || write.size() != stage.size())
    throw Error("/timing and /bandwidth do not fit one another");
  for (std::size_t t = 0; t < shape[0]; ++t) {
    TimedTrial trial;
    trial.index = static_cast<int>(index[t]);
    trial.pipelined_wall_s = pipelined[t];
    for (std::size_t k = t * shape[1]; k < (t + 1) * shape[1]; ++k) {
      if (std::isnan(wall[k])) break;  // padding of a shorter trial
      trial.frame_wall_s.push_back(wall[k]);
      trial.frame_device_s.push_back(device[k]);
      const auto append = [&](std::vector<double>& to, const std::vector<double>& from) {
        to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(k * stages), from.begin() + static_cast<std::ptrdiff_t>((k + 1) * stages));
      };
      append(trial.stage_device_s, stage);
      append(trial.stage_read_B, read);
      append(trial.stage_write_B, write);
    }
    r.trials.push_back(std::move(trial));
  }
}

herr_t collect_link(hid_t, const char* name, const H5L_info_t*, void* out) {
  static_cast<std::vector<std::string>*>(out)->emplace_back(name);
  return 0;
}

void read_accuracy(hid_t file, CellRecord& r, bool with_trajectory) {
  const Id metrics = open_group(file, "metrics");
  r.accuracy.time_s = numbers<double>(metrics, "time_s", H5T_NATIVE_DOUBLE);
  if (with_trajectory) r.accuracy.position = numbers<float>(file, "VTKHDF/Points", H5T_NATIVE_FLOAT);
  if (with_trajectory)
    for (std::int64_t v : numbers<std::int64_t>(file, "triangles", H5T_NATIVE_INT64)) r.header.triangles.push_back(static_cast<std::uint32_t>(v));
  std::vector<std::string> names;
  h5::check(H5Literate(metrics, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect_link, &names), "listing /metrics");
  for (const std::string& n : names) {
    if (n == "time_s" || n == "frame") continue;
    const Id d(H5Dopen2(metrics, n.c_str(), H5P_DEFAULT), H5Dclose, "opening " + n);
    r.accuracy.metrics.push_back({n, text_attribute(d, "units"), text_attribute(d, "long_name"), numbers<double>(metrics, n.c_str(), H5T_NATIVE_DOUBLE)});
  }
}

}  // namespace

CellRecord read_hdf5(const std::filesystem::path& path, bool with_trajectory) {
  const h5::Quiet quiet;
  try {
    const Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "opening the file");
    if (text_attribute(file, "format") != "clothbench-run") throw Error("not a clothbench run (attribute format)");
    if (const double version = number_attribute(file, "format_version"); version != 1)
      throw Error("format_version " + std::to_string(static_cast<int>(version)) + "; this build reads 1");
    CellRecord r;
    nlohmann::json header = nlohmann::json::parse(text_dataset(file, "header_json"));
    header["triangles"] = nlohmann::json::array();
    r.header = header_from_json(header);
    read_scalars(file, r);
    if (exists(file, "timing")) read_trials(file, r);
    if (exists(file, "metrics")) read_accuracy(file, r, with_trajectory);
    return r;
  } catch (const nlohmann::json::exception& e) {
    throw Error(path.string() + ": header_json: " + e.what());
  } catch (const Error& e) {
    throw Error(path.string() + ": " + e.what());
  }
}

}  // namespace clothbench
