#pragma once
#include <vector>

#include "clothbench/record.hpp"

namespace clothbench {

/// Greatest distance of a vertex in one run from the same vertex in another [m], and the root mean square over the
/// vertices. NaN and nothing where the two have no trajectories of the same length.
struct Apart {
  double end_m = kMissing, max_m = kMissing;
  std::vector<double> rms_m = {};  ///< by frame
};

/// Reads the trajectories from the runs' files where the records do not hold them. With `transposed_columns`, those of
/// the first run's grid, the second run's grid is numbered along its other side first.
Apart trajectories_apart(const RunRecord& a, const RunRecord& b, std::size_t transposed_columns = 0);

}  // namespace clothbench
