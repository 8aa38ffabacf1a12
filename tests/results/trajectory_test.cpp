// A file whose positions do not match the outcome is found, whatever its summary says.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <unistd.h>

#include <functional>
#include <limits>

#include "refusal.hpp"
#include "results/part_file.hpp"
#include "results/store.hpp"
#include "sample_run.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

class Trajectory : public WithFolder {
 protected:
  void SetUp() override {
    run_ = sample_run();
    run_.outcome = {};
    write();
  }

  void write() { write_hdf5(file(), run_); }
  fs::path file() const { return dir_ / "x.h5"; }

  template <class T>
  void overwrite(const char* dataset, hid_t type, const std::vector<T>& values) const {
    const hid_t f = H5Fopen(file().c_str(), H5F_ACC_RDWR, H5P_DEFAULT), d = H5Dopen2(f, dataset, H5P_DEFAULT);
    ASSERT_GE(H5Dwrite(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0) << dataset;
    H5Dclose(d);
    H5Fclose(f);
  }

  /// Keeps only the first `rows` rows of a dataset.
  void cut(const char* dataset, hid_t type, hsize_t rows, hsize_t columns) const {
    const hid_t f = H5Fopen(file().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    ASSERT_GE(H5Ldelete(f, dataset, H5P_DEFAULT), 0) << dataset;
    const hsize_t size[2] = {rows, columns};
    const hid_t space = H5Screate_simple(columns > 1 ? 2 : 1, size, nullptr),
                d = H5Dcreate2(f, dataset, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const std::vector<double> times = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    if (columns == 1) {
      ASSERT_GE(H5Dwrite(d, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, times.data()), 0);
    }
    H5Dclose(d);
    H5Sclose(space);
    H5Fclose(f);
  }

  RunRecord run_;
};

TEST_F(Trajectory, AWholeFileHasNoFault) {
  EXPECT_EQ(trajectory_fault(file()), "");
  EXPECT_EQ(read_hdf5(file(), 0).outcome.trajectory_sha256, trajectory_sha256(run_.accuracy));
  EXPECT_EQ(trajectory_sha256(run_.accuracy).size(), 64u);
}

TEST_F(Trajectory, ANumberThatIsNoneIsFound) {
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    std::vector<float> x = run_.accuracy.position;
    x[3 * (6 * 2 + 4) + 1] = wrong;
    overwrite("trajectory/position", H5T_NATIVE_FLOAT, x);
    EXPECT_PRED2(mentions, trajectory_fault(file()), "vertex 4 in frame 2 is not finite");
  }
}

/// As a program would store it if its solver gave a NaN: the hash matches.
TEST_F(Trajectory, ANumberThatIsNoneIsFoundAlsoWithItsHash) {
  run_.accuracy.position[7] = std::numeric_limits<float>::quiet_NaN();
  write();
  EXPECT_PRED2(mentions, trajectory_fault(file()), "is not finite");
  run_.outcome.status = "not_finite";
  write();
  EXPECT_EQ(trajectory_fault(file()), "") << "that is what the outcome says";
}

TEST_F(Trajectory, AnotherMotionIsFound) {
  std::vector<float> x = run_.accuracy.position;
  x[5] += 1e-6f;
  overwrite("trajectory/position", H5T_NATIVE_FLOAT, x);
  EXPECT_PRED2(mentions, trajectory_fault(file()), "do not match the outcome");
  run_.outcome.status = "diverged";
  write();
  overwrite("trajectory/position", H5T_NATIVE_FLOAT, x);
  EXPECT_PRED2(mentions, trajectory_fault(file()), "do not match the outcome");
}

TEST_F(Trajectory, OtherTimesAreFound) {
  std::vector<double> t = run_.accuracy.time_s;
  for (double& v : t) v *= 2;
  overwrite("metrics/time_s", H5T_NATIVE_DOUBLE, t);
  EXPECT_PRED2(mentions, trajectory_fault(file()), "do not match the outcome");
  t[3] = t[2];
  overwrite("metrics/time_s", H5T_NATIVE_DOUBLE, t);
  EXPECT_PRED2(mentions, trajectory_fault(file()), "the time of frame 3");
}

TEST_F(Trajectory, MissingFramesAreFound) {
  cut("trajectory/position", H5T_IEEE_F32LE, 2 * 6, 3);
  EXPECT_PRED2(mentions, trajectory_fault(file()), "expected 90 coordinates of 5 frames with 6 vertices; found 36");
  cut("metrics/time_s", H5T_IEEE_F64LE, 2, 1);
  EXPECT_PRED2(mentions, trajectory_fault(file()), "2 frames have positions, 5 have");
}

TEST_F(Trajectory, NoMotionAtAllIsFoundWhereThereMustBeOne) {
  run_.accuracy = {};
  write();
  EXPECT_PRED2(mentions, trajectory_fault(file()), "no positions");
  run_.outcome.status = "unsupported";
  write();
  EXPECT_EQ(trajectory_fault(file()), "");
}

TEST_F(Trajectory, ACborFileIsLookedAtToo) {
  RunWriter writer(dir_, run_.header, Finish::Cbor);
  run_.accuracy.position[7] = std::numeric_limits<float>::quiet_NaN();
  writer.write_accuracy(run_.accuracy);
  EXPECT_PRED2(mentions, trajectory_fault(writer.finish({}, {})), "is not finite");
}

// Files that HDF5 can read but no run has written: cases found by fuzzing the reader.

/// Error message from reading a valid file after `change`.
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
