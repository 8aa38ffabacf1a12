#pragma once
#include "clothbench/record.hpp"

namespace clothbench {

/// Greatest distance of a vertex in one cell from the same vertex in another [m]. NaN where the two have no
/// trajectories of the same length.
struct Apart {
  double end_m = kMissing, max_m = kMissing;
};

/// Reads the trajectories from the cells' files where the records do not hold them.
Apart trajectories_apart(const CellRecord& a, const CellRecord& b);

}  // namespace clothbench
