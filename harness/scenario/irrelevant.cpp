#include "scenario/irrelevant.hpp"

#include <map>

#include "scenario/collider_kinds.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr double kNegligible = 1e-30;
constexpr double kFriction = 0.5;

/// One collider per feature, in different directions. A sheet falls 4.9 m in a second, so it does not reach them.
std::map<Feature, json> far_colliders() {
  std::map<Feature, json> out;
  for (const ColliderKind& kind : collider_kinds()) out.insert(kind.far.begin(), kind.far.end());
  return out;
}

}  // namespace

json with_irrelevant(json scenario, FeatureSet needs, FeatureSet wanted) {
  const FeatureSet missing = wanted - needs;
  json added = json::array();
  const auto note = [&](Feature f) { added.push_back(name_of(f)); };
  if (missing.has(Feature::Bend)) {
    scenario["material"]["bending_rigidity_N_m"] = kNegligible;
    note(Feature::Bend);
  }
  if (missing.has(Feature::Damping)) {
    scenario["material"]["damping_per_s"] = kNegligible;
    note(Feature::Damping);
  }
  json colliders = scenario.value("colliders", json::array());
  const std::size_t own = colliders.size();
  for (auto& [feature, collider] : far_colliders())
    if (missing.has(feature)) {
      if (wanted.has(Feature::Friction)) collider["friction"] = kFriction;
      colliders.push_back(std::move(collider));
      note(feature);
    }
  if (missing.has(Feature::Friction) && !colliders.empty()) {
    if (colliders.size() == own) colliders[0]["friction"] = kNegligible;
    note(Feature::Friction);
  }
  const bool single = scenario["cloth"]["sides"] == "single", doubled = scenario["cloth"]["sides"] == "double";
  if (missing.has(Feature::DoubleSided) && (single || doubled) && own == 0 && !colliders.empty()) {
    scenario["cloth"]["sides"] = "double";
    note(Feature::DoubleSided);
  }
  // A solver ignores sides while the cloth touches nothing. With colliders in the scene it would have to support them.
  if (doubled && own == 0 && !colliders.empty() && !wanted.has(Feature::DoubleSided))
    scenario["cloth"]["sides"] = "single";
  if (added.empty()) return scenario;
  if (!colliders.empty()) scenario["colliders"] = std::move(colliders);
  scenario["irrelevant"] = std::move(added);
  scenario.erase("truth");
  scenario.erase("expect");
  return scenario;
}

}  // namespace clothbench
