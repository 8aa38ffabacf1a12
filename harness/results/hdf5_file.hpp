#pragma once
#include <filesystem>
#include <string>

#include "clothbench/error.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

#ifdef CLOTHBENCH_HAS_HDF5
inline constexpr bool kWithHdf5 = true;

/// Writes one result file (layout in results/README.md) by tmp + fsync + rename. Throws Error naming the file.
void write_hdf5(const std::filesystem::path&, const RunRecord&);

/// Reads a result file, with positions of every `stride`-th frame and the last. Stride 0: without positions, `replay`
/// and triangles of a grid.
RunRecord read_hdf5(const std::filesystem::path&, std::size_t stride);

/// Writes a sidecar with which ParaView opens the trajectory and the static meshes: per frame one grid over
/// /frames/NNNNNN of `h5_name`, or a collection of the cloth and the static meshes if there are any.
void write_xdmf(const std::filesystem::path&, const std::string& h5_name, const RunRecord&);
#else
inline constexpr bool kWithHdf5 = false;

inline void write_hdf5(const std::filesystem::path& path, const RunRecord&) {
  throw Error(path.string() + ": this build writes no HDF5; convert the run with `clothbench import` elsewhere");
}
inline RunRecord read_hdf5(const std::filesystem::path& path, std::size_t) {
  throw Error(path.string() + ": this build reads no HDF5");
}
inline void write_xdmf(const std::filesystem::path&, const std::string&, const RunRecord&) {}
#endif

}  // namespace clothbench
