#pragma once
// Included only by the HDF5 writer and reader: owner class for all identifiers of the C API.
#include <hdf5.h>
#include <hdf5_hl.h>

#include <string>
#include <utility>
#include <vector>

#include "clothbench/error.hpp"

namespace clothbench::h5 {

/// Owns an HDF5 identifier. Throws Error naming `what` if the call that returned it failed.
class Id {
 public:
  Id(hid_t id, herr_t (*close)(hid_t), const std::string& what) : id_(id), close_(close) {
    if (id < 0) throw Error("HDF5: " + what + " failed");
  }
  Id(Id&& o) noexcept : id_(std::exchange(o.id_, -1)), close_(o.close_) {}
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }  // NOLINT: this is what the C API takes

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

inline void check(herr_t result, const std::string& what) {
  if (result < 0) throw Error("HDF5: " + what + " failed");
}

/// Stops the library from printing its error stack, because our errors are one line.
inline void be_quiet() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

using Dims = std::vector<hsize_t>;

inline Id space(const Dims& dims) {
  return dims.empty()
             ? Id(H5Screate(H5S_SCALAR), H5Sclose, "H5Screate")
             : Id(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr), H5Sclose, "H5Screate_simple");
}

/// Variable-length UTF-8 string.
inline Id string_type() {
  Id t(H5Tcopy(H5T_C_S1), H5Tclose, "H5Tcopy");
  check(H5Tset_size(t, H5T_VARIABLE), "H5Tset_size");
  check(H5Tset_cset(t, H5T_CSET_UTF8), "H5Tset_cset");
  return t;
}

}  // namespace clothbench::h5
