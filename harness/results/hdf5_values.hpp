#pragma once
// Included only by code that reads HDF5 files: datasets and attributes as values. Throws Error naming what is missing.
#include "clothbench/record.hpp"
#include "results/hdf5_handle.hpp"

namespace clothbench::h5 {

inline constexpr hsize_t kMostValues = hsize_t{1} << 31;

inline bool exists(hid_t at, const char* name) { return H5Lexists(at, name, H5P_DEFAULT) > 0; }

inline Dims dims_of(hid_t d) {
  const Id space(H5Dget_space(d), H5Sclose, "H5Dget_space");
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0) throw Error("a dataset without extent");
  Dims dims(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space, dims.data(), nullptr);
  return dims;
}

inline hsize_t product(const Dims& dims) {
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

inline std::string take_text(char* text) {
  std::string out = text == nullptr ? "" : text;
  H5free_memory(text);
  return out;
}

inline void require_text(hid_t type) {
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) <= 0) throw Error("expected variable-length text");
}

inline std::string text_attribute(hid_t at, const char* name) {
  const Id a(H5Aopen(at, name, H5P_DEFAULT), H5Aclose, std::string("attribute ") + name),
      stored(H5Aget_type(a), H5Tclose, "H5Aget_type"), type = string_type(),
                                                       space(H5Aget_space(a), H5Sclose, "H5Aget_space");
  require_text(stored);
  if (H5Sget_simple_extent_npoints(space) != 1) throw Error(std::string("attribute ") + name + ": expected one text");
  char* text = nullptr;
  check(H5Aread(a, type, &text), std::string("attribute ") + name);
  return take_text(text);
}

inline std::string text_dataset(hid_t at, const char* name) {
  const Id d(H5Dopen2(at, name, H5P_DEFAULT), H5Dclose, std::string("opening ") + name),
      stored(H5Dget_type(d), H5Tclose, "H5Dget_type"), type = string_type();
  require_text(stored);
  if (product(dims_of(d)) != 1) throw Error(std::string(name) + ": expected one text");
  char* text = nullptr;
  check(H5Dread(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &text), std::string("reading ") + name);
  return take_text(text);
}

inline double number_attribute(hid_t at, const char* name) {
  const Id a(H5Aopen(at, name, H5P_DEFAULT), H5Aclose, std::string("attribute ") + name),
      space(H5Aget_space(a), H5Sclose, "H5Aget_space");
  if (H5Sget_simple_extent_npoints(space) != 1) throw Error(std::string("attribute ") + name + ": expected one number");
  double v = kMissing;
  check(H5Aread(a, H5T_NATIVE_DOUBLE, &v), std::string("attribute ") + name);
  return v;
}

inline herr_t collect_name(hid_t, const char* name, const H5A_info_t*, void* out) {
  static_cast<std::vector<std::string>*>(out)->emplace_back(name);
  return 0;
}
inline herr_t collect_link(hid_t, const char* name, const H5L_info_t*, void* out) {
  static_cast<std::vector<std::string>*>(out)->emplace_back(name);
  return 0;
}

inline std::vector<std::string> attribute_names(hid_t at) {
  std::vector<std::string> names;
  check(H5Aiterate2(at, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect_name, &names), "listing attributes");
  return names;
}
inline std::vector<std::string> link_names(hid_t group) {
  std::vector<std::string> names;
  check(H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect_link, &names), "listing a group");
  return names;
}

}  // namespace clothbench::h5
