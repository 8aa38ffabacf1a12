#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/leak.hpp"

namespace clothbench {

/// A scene and the same with its square cloth turned over: axis_u and axis_v (and what is held, u0 for v0) change
/// places, so that vertices and triangles lie where they did and all normals point the other way. A study's axis with
/// the label "turned" makes its name. Points into the vector the set-ups were made from.
struct TurnedPair {
  std::string kind, scene;
  Series series;
  const RunRecord *run = nullptr, *turned = nullptr;
  /// Distance of the vertices that were in the same places at the start, RMS over the cloth, over its longer side:
  /// greatest up to 0.1 s after the first contact, and at the end.
  double apart_at_contact = kMissing, apart_end = kMissing;

  /// Both ran, both leak or neither does (`leak_of`), and they were at most a twentieth of the longer side apart at
  /// contact. Later a cloth that falls into folds takes whichever way rounding tips it.
  bool same() const;
};

/// Reads trajectories from the runs' files.
std::vector<TurnedPair> turned_pairs(const std::vector<ContactSetUp>&);

Table turned_table(const std::vector<TurnedPair>&);

nlohmann::json turned_json(const std::vector<TurnedPair>&);

}  // namespace clothbench
