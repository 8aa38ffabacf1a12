#pragma once
#include <filesystem>

#include "clothbench/record.hpp"
#include "results/store.hpp"

namespace clothbench {

#ifdef CLOTHBENCH_HAS_HDF5
inline constexpr bool kWithHdf5 = true;
#else
inline constexpr bool kWithHdf5 = false;  // the two functions below then throw
#endif

/// One result file, layout in results/README.md. tmp + fsync + rename; throws Error naming the file.
void write_hdf5(const std::filesystem::path&, const RunRecord&);

/// Reads one back; without `with_trajectory` positions and metric series stay empty. `replay` always does: see
/// read_hdf5_replay.
RunRecord read_hdf5(const std::filesystem::path&, bool with_trajectory);

/// What `read_replay` gives of a finished file.
Replay read_hdf5_replay(const std::filesystem::path&, std::size_t stride);

}  // namespace clothbench
