#pragma once
#include <vector>

#include "clothbench/record.hpp"

namespace clothbench {

/// Distance between the positions of each vertex in two runs [m]: greatest, and root mean square over the vertices. NaN
/// and empty if the two have no trajectories of the same length.
struct Apart {
  double end_m = kMissing, max_m = kMissing;
  std::vector<double> rms_m = {};  ///< by frame
};

/// Reads the trajectories from the runs' files if the records do not hold them. `transposed_columns`: if not 0, the
/// number of columns of the first run's grid; the vertices of the second run are then numbered as in its transpose.
Apart trajectories_apart(const RunRecord& a, const RunRecord& b, std::size_t transposed_columns = 0);

}  // namespace clothbench
