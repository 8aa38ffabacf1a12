#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/penetration.hpp"

namespace clothbench {

/// A run of a scene in which a moving collider releases the cloth, and a run of the same solver with sixteen times the
/// substeps (the study's entry with the label "x16"). Points into the vector the set-ups were made from.
struct Popping {
  std::string scene;
  Series series;
  const RunRecord *run = nullptr, *finer = nullptr;

  double ratio() const;  ///< of the greatest displacements within three frames after the last contact; NaN if unknown
  bool passed() const;   ///< both ran, ratio at most 1.2, greatest speed within its limit (pop_speed_ratio at most 1)
};

inline constexpr const char* kFinerLabel = "x16";

/// Runs with the setting "default" that have a finer one of the same scene, solver and sides.
std::vector<Popping> poppings(const std::vector<ContactSetUp>&);

Table popping_table(const std::vector<Popping>&);

nlohmann::json popping_json(const std::vector<Popping>&);

}  // namespace clothbench
