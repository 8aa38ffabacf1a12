// Files that HDF5 reads and no run has written: what fuzzing the reader found, each as it was.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <unistd.h>

#include <functional>

#include "refusal.hpp"
#include "results/hdf5_file.hpp"
#include "sample_run.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

/// Message of reading a good file after `change`.
std::string said(const std::function<void(hid_t file)>& change) {
  const fs::path path = fs::temp_directory_path() / ("clothbench-damage-" + std::to_string(getpid()) + ".h5");
  write_hdf5(path, sample_run());
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  change(file);
  H5Fclose(file);
  std::string out;
  for (const std::size_t stride : {1, 2}) out += refusal([&] { read_hdf5(path, stride); }) + "; ";
  fs::remove(path);
  return out;
}

void set_attribute(hid_t file, const char* holder, const char* name, hid_t type, hid_t space, const void* value) {
  H5Adelete_by_name(file, holder, name, H5P_DEFAULT);
  const hid_t a = H5Acreate_by_name(file, holder, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  ASSERT_GE(a, 0);
  ASSERT_GE(H5Awrite(a, type, value), 0);
  H5Aclose(a);
}

void set_number(hid_t file, const char* holder, const char* name, double value) {
  const hid_t space = H5Screate(H5S_SCALAR);
  set_attribute(file, holder, name, H5T_NATIVE_DOUBLE, space, &value);
  H5Sclose(space);
}

TEST(DamagedHdf5, NumbersThatNoIntHolds) {
  for (const double v : {1.09904e+248, -1e300, static_cast<double>(NAN)}) {
    EXPECT_PRED2(mentions, said([&](hid_t f) { set_number(f, ".", "format_version", v); }),
                 "attribute format_version: expected a whole number")
        << v;
    EXPECT_PRED2(mentions, said([&](hid_t f) { set_number(f, "outcome", "failed_frame", v); }),
                 "attribute failed_frame: expected a whole number")
        << v;
  }
}

TEST(DamagedHdf5, SeveralTextsWhereOneIsExpected) {
  const hid_t text = H5Tcopy(H5T_C_S1);
  H5Tset_size(text, H5T_VARIABLE);
  const hsize_t many = 7;
  const hid_t space = H5Screate_simple(1, &many, nullptr);
  const char* const words[7] = {"a", "b", "c", "d", "e", "f", "g"};
  EXPECT_PRED2(mentions, said([&](hid_t f) { set_attribute(f, ".", "format", text, space, words); }),
               "attribute format: expected one text");
  EXPECT_PRED2(mentions, said([&](hid_t f) { set_attribute(f, "outcome", "status", text, space, words); }),
               "attribute status: expected one text");
  H5Sclose(space);
  H5Tclose(text);
}

}  // namespace
}  // namespace clothbench
