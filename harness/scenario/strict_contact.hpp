#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "clothbench/scene.hpp"

namespace clothbench {

/// Whether penetration depth is defined for a collider. True for all shapes except meshes (the inside of a plane is the
/// half-space behind it), for closed meshes with outward normals, and for skinned meshes, which are hands open at most
/// at the wrist. Rooms have no inside.
bool has_inside(const Collider&);

/// One bound of the strict set: contact without any leak, and cloth that stays whole.
struct StrictBound {
  const char* scalar;
  double at_most;
  bool (*defined)(const Scene&);  ///< whether the scene has what the scalar measures
};

/// The strict set. Source of the limits: README of scenarios/, "Strict contact".
const std::vector<StrictBound>& strict_contact();

/// Replaces `"contact": "strict"` of a scene's `expect` by the bounds of the strict set that are defined for the scene.
/// A bound that the scene states itself stays. Throws Error naming `source` and the JSON pointer if such a bound is
/// looser than the set's and states no reason ("why"), or if there is nothing to touch or hold.
void complete_expect(nlohmann::json& expect, const Scene&, const std::string& source);

}  // namespace clothbench
