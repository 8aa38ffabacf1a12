#include "clothbench/error.hpp"
#include "results/hdf5_file.hpp"

namespace clothbench {

void write_hdf5(const std::filesystem::path& path, const RunRecord&) {
  throw Error(path.string() +
              ": this build writes no HDF5; convert raw run files with `clothbench import` on another machine");
}

RunRecord read_hdf5(const std::filesystem::path& path, bool) {
  throw Error(path.string() + ": this build reads no HDF5");
}

std::string read_hdf5_trajectory_sha256(const std::filesystem::path& path) {
  throw Error(path.string() + ": this build reads no HDF5");
}

Replay read_hdf5_replay(const std::filesystem::path& path, std::size_t) {
  throw Error(path.string() + ": this build reads no HDF5");
}

}  // namespace clothbench
