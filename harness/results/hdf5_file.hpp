#pragma once
#include <filesystem>

#include "clothbench/record.hpp"
#include "results/store.hpp"

namespace clothbench {

#ifdef CLOTHBENCH_HAS_HDF5
inline constexpr bool kWithHdf5 = true;
#else
inline constexpr bool kWithHdf5 = false;  // the functions below then throw
#endif

/// Writes one result file (layout in results/README.md) by tmp + fsync + rename. Throws Error naming the file.
void write_hdf5(const std::filesystem::path&, const RunRecord&);

/// Reads a result file. Without `with_trajectory`, positions and metric series stay empty. `replay` always stays empty:
/// see read_hdf5_replay.
RunRecord read_hdf5(const std::filesystem::path&, bool with_trajectory);

/// The hash of the motion that the file's outcome is of (results/trajectory.hpp); empty if it stores none.
std::string read_hdf5_trajectory_sha256(const std::filesystem::path&);

/// `read_replay` for a finished file.
Replay read_hdf5_replay(const std::filesystem::path&, std::size_t stride);

}  // namespace clothbench
