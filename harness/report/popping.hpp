#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/penetration.hpp"

namespace clothbench {

/// A run of a scene in which a moving collider lets go of the cloth, beside that of the same solver at sixteen times
/// its substeps: a study's entry of that solver with the label "x16". Points into the vector the set-ups were made
/// from.
struct Popping {
  std::string scene;
  Series series;
  const RunRecord *run = nullptr, *finer = nullptr;

  double ratio() const;  ///< of the way of the fastest vertex within three frames after the last contact; NaN if either
                         ///< is not known
  bool passed() const;   ///< both ran, ratio at most 1.2, no speed above its limit (pop_speed_ratio at most 1)
};

inline constexpr const char* kFinerLabel = "x16";

/// Runs with the setting "default" that have a finer one of the same scene, solver and sides.
std::vector<Popping> poppings(const std::vector<ContactSetUp>&);

Table popping_table(const std::vector<Popping>&);

nlohmann::json popping_json(const std::vector<Popping>&);

}  // namespace clothbench
