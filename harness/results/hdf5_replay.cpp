#include "results/hdf5_file.hpp"
#include "results/hdf5_handle.hpp"
#include "results/hdf5_values.hpp"

namespace clothbench {
namespace {

using h5::Dims;
using h5::Id;

/// Rows of the frames wanted, of a dataset (frame × vertex, xyz).
std::vector<float> rows_of(hid_t file, const std::vector<std::size_t>& frames, std::size_t vertices) {
  const Id d(H5Dopen2(file, "VTKHDF/Points", H5P_DEFAULT), H5Dclose, "opening VTKHDF/Points"),
      space(H5Dget_space(d), H5Sclose, "H5Dget_space");
  const Dims dims = h5::dims_of(d);
  if (dims.size() != 2 || dims[1] != 3 || dims[0] < (frames.back() + 1) * vertices)
    throw Error("VTKHDF/Points: expected as many points as times and vertices say");
  std::vector<float> out(frames.size() * vertices * 3);
  const hsize_t count[2] = {vertices, 3};
  const Id memory = h5::space({vertices, 3});
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const hsize_t start[2] = {frames[k] * vertices, 0};
    h5::check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, count, nullptr), "selecting a frame");
    h5::check(H5Dread(d, H5T_NATIVE_FLOAT, memory, space, H5P_DEFAULT, &out[k * vertices * 3]),
              "reading VTKHDF/Points");
  }
  return out;
}

/// A text, a number or a list of numbers: what write_hdf5 makes of a StoredGroup's attributes.
nlohmann::json attribute_value(hid_t at, const std::string& name) {
  const Id a(H5Aopen(at, name.c_str(), H5P_DEFAULT), H5Aclose, "attribute " + name),
      type(H5Aget_type(a), H5Tclose, "H5Aget_type"), space(H5Aget_space(a), H5Sclose, "H5Aget_space");
  if (H5Tget_class(type) == H5T_STRING) return h5::text_attribute(at, name.c_str());
  const hssize_t n = H5Sget_simple_extent_npoints(space);
  if (n < 0 || n > 64) throw Error("attribute " + name + ": expected one number or a short list of numbers");
  std::vector<double> values(static_cast<std::size_t>(n));
  h5::check(H5Aread(a, H5T_NATIVE_DOUBLE, values.data()), "attribute " + name);
  if (H5Sget_simple_extent_type(space) == H5S_SCALAR) return values.at(0);
  return values;
}

/// Every attribute and every dataset of a group but the scales of its dimensions.
StoredGroup read_group(hid_t file, const std::string& path) {
  const Id group(H5Gopen2(file, path.c_str(), H5P_DEFAULT), H5Gclose, "group " + path);
  StoredGroup g;
  g.path = path;
  for (const std::string& name : h5::attribute_names(group)) g.attributes[name] = attribute_value(group, name);
  for (const std::string& name : h5::link_names(group)) {
    const Id object(H5Oopen(group, name.c_str(), H5P_DEFAULT), H5Oclose, "opening " + name);
    if (H5Iget_type(object) != H5I_DATASET || H5DSis_scale(object) > 0) continue;
    const Id type(H5Dget_type(object), H5Tclose, "H5Dget_type");
    StoredArray& a = g.arrays.emplace_back();
    a.name = name;
    a.integer = H5Tget_class(type) == H5T_INTEGER;
    Dims shape;
    a.values = h5::numbers<double>(group, name.c_str(), H5T_NATIVE_DOUBLE, &shape);
    a.shape.assign(shape.begin(), shape.end());
  }
  return g;
}

/// The group `path`, if the file has it, and those in it that it counts.
void read_part(hid_t file, const std::string& path, std::vector<StoredGroup>& out) {
  if (!h5::exists(file, path.c_str())) return;
  out.push_back(read_group(file, path));
  const auto count = out.back().attributes.at("count").get<double>();
  for (int k = 0; k < count; ++k) out.push_back(read_group(file, path + "/" + std::to_string(k)));
  if (const std::string grips = path + "/grips"; h5::exists(file, grips.c_str()))
    out.push_back(read_group(file, grips));
}

}  // namespace

Replay read_hdf5_replay(const std::filesystem::path& path, std::size_t stride) {
  const h5::Quiet quiet;
  try {
    const Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "opening the file");
    Replay r;
    if (!h5::exists(file, "VTKHDF")) return r;
    const std::vector<double> time_s = h5::numbers<double>(file, "metrics/time_s", H5T_NATIVE_DOUBLE);
    const auto vertices = static_cast<std::size_t>(
        nlohmann::json::parse(h5::text_dataset(file, "header_json")).at("vertices").get<std::uint32_t>());
    r.frames = every(time_s.size(), stride);
    if (r.frames.empty()) return r;
    for (const std::size_t f : r.frames) r.time_s.push_back(time_s[f]);
    r.position = rows_of(file, r.frames, vertices);
    for (const char* part : {"cloth", "colliders"}) read_part(file, part, r.groups);
    return r;
  } catch (const nlohmann::json::exception& e) {
    throw Error(path.string() + ": header_json, /cloth or /colliders: " + e.what());
  } catch (const Error& e) {
    throw Error(path.string() + ": " + e.what());
  }
}

}  // namespace clothbench
