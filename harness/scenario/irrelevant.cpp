#include "scenario/irrelevant.hpp"

#include <utility>

namespace clothbench {
namespace {

using nlohmann::json;

constexpr double kNegligible = 1e-30;
constexpr double kFar = 100;  // m
constexpr double kFriction = 0.5;

/// Colliders of one kind each, on every side of the cloth. A sheet falls 4.9 m in a second: nothing comes near.
std::vector<std::pair<Feature, json>> far_colliders() {
  return {
      {Feature::Sphere, {{"type", "sphere"}, {"center_m", {kFar, 0, 0}}, {"radius_m", 1}}},
      {Feature::Box, {{"type", "box"}, {"center_m", {-kFar, 0, 0}}, {"size_m", {1, 1, 1}}}},
      {Feature::Plane, {{"type", "plane"}, {"point_m", {0, -kFar, 0}}, {"normal", {0, 1, 0}}}},
      {Feature::Capsules,
       {{"type", "hand_capsules"}, {"track", "assets/right-hand-sweep.json"}, {"offset_m", {0, 0, kFar}}}},
      {Feature::StaticMesh,
       {{"type", "mesh"}, {"positions_m", {{-1, 0, -kFar}, {1, 0, -kFar}, {0, 1, -kFar}}}, {"triangles", {{0, 1, 2}}}}},
      {Feature::MovingMesh,
       {{"type", "hand_mesh"}, {"track", "assets/right-hand-sweep.json"}, {"offset_m", {kFar, 0, kFar}}}}};
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
