#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/leak.hpp"

namespace clothbench {

/// A run of a scene, and one of the same scene with its square cloth turned over: axis_u and axis_v (and the held
/// edges, u0 for v0) are exchanged, so that all vertices keep their places and all normals are reversed. Its name has
/// the label "turned" of a study's axis. Points into the vector the set-ups were made from.
struct TurnedPair {
  std::string kind, scene;
  Series series;
  const RunRecord *run = nullptr, *turned = nullptr;
  /// Distance between vertices that started at the same place, RMS over the cloth, over its longer side: maximum until
  /// 0.1 s after the first contact, and at the end.
  double apart_at_contact = kMissing, apart_end = kMissing;

  /// Both ran, both or neither leak (`leak_of`), and they were at most a twentieth of the longer side apart at contact.
  /// The later difference is not judged, since rounding decides how a cloth falls into folds.
  bool same() const;
};

/// Reads trajectories from the runs' files.
std::vector<TurnedPair> turned_pairs(const std::vector<ContactSetUp>&);

Table turned_table(const std::vector<TurnedPair>&);

nlohmann::json turned_json(const std::vector<TurnedPair>&);

}  // namespace clothbench
