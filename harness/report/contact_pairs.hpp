#pragma once
#include <nlohmann/json.hpp>
#include <vector>

#include "report/pairs.hpp"

namespace clothbench {

/// Pairs of runs with contact (pairs.hpp) in the order of the set-ups, whose runs must outlive them.

/// "turned-over": a run of a scene, and one with its square cloth turned over, so that all vertices keep their places
/// and all normals are reversed. Without runs of the solver that touches nothing.
std::vector<RunPair> turned_pairs(const std::vector<ContactSetUp>&);
/// Both ran, both or neither leak (`leak_of`), and they were within the bound at contact.
bool same_from_both_sides(const RunPair&);
Table turned_table(const std::vector<RunPair>&);
nlohmann::json turned_json(const std::vector<RunPair>&);

/// "finer": a run of a scene in which a moving collider releases the cloth, and one of the same solver with more
/// substeps.
std::vector<RunPair> popping_pairs(const std::vector<ContactSetUp>&);
/// Both ran, the ratio of displacements within its bound, the greatest speed within its limit.
bool popping_passed(const RunPair&);
Table popping_table(const std::vector<RunPair>&);
nlohmann::json popping_json(const std::vector<RunPair>&);

/// "whole-room": the part of a room round a table, and the whole room. Tests section 3.2.4 of Kim, Ma & Hong 2025,
/// which cuts a SubMesh out of the room to save time.
/// Two rows a pair and their ratio: time, bytes, memory. The note has the distances.
Table room_table(const std::vector<RunPair>&);
nlohmann::json room_json(const std::vector<RunPair>&);

}  // namespace clothbench
