#pragma once
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// Two runs that differ only in the collider: the part of a room round a table, or the whole room. Tests section 3.2.4
/// of Kim, Ma & Hong 2025, which cuts a SubMesh out of the room to save time.
struct RoomPair {
  const RunRecord* cut = nullptr;
  const RunRecord* whole = nullptr;
  /// Greatest distance between the positions of a vertex in the two runs [m], at the end and over all frames. NaN if
  /// the two have no trajectories of the same length.
  double distance_end_m = kMissing, distance_max_m = kMissing;
};

/// Every such pair of the same scene, solver, settings and sides; `whole` has `cut` "none" for its rooms. Reads the
/// trajectories from the runs' files. `runs` must outlive the result.
std::vector<RoomPair> room_pairs(const std::vector<RunRecord>& runs);

/// Two rows a pair and their ratio: time, bytes, memory. The note has the distances.
Table room_table(const std::vector<RoomPair>&);

nlohmann::json room_json(const std::vector<RoomPair>&);

}  // namespace clothbench
