#pragma once
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// Two runs that differ in one thing: whether the cloth met the part of a room round a table or the whole room. Tests
/// section 3.2.4 of Kim, Ma & Hong 2025, which cuts a SubMesh out of the room to save time.
struct RoomPair {
  const RunRecord* cut = nullptr;
  const RunRecord* whole = nullptr;
  /// Greatest distance of a vertex in one from the same vertex in the other [m], at the end and over all frames. NaN
  /// where the two have no trajectories of the same length.
  double distance_end_m = kMissing, distance_max_m = kMissing;
};

/// Every such pair: the same scene, solver, settings and sides; `whole` has `cut` "none" for its rooms. Reads the
/// trajectories of those runs from their files. `runs` must outlive the answer.
std::vector<RoomPair> room_pairs(const std::vector<RunRecord>& runs);

/// Two rows a pair and their ratio: time, bytes, memory; the distances in the note.
Table room_table(const std::vector<RoomPair>&);

nlohmann::json room_json(const std::vector<RoomPair>&);

}  // namespace clothbench
