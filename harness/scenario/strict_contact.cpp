#include "scenario/strict_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/json_text.hpp"

namespace clothbench {
namespace {

template <bool (*kTest)(const Collider&)>
bool any_collider(const Scene& s) {
  return std::any_of(s.colliders.begin(), s.colliders.end(), kTest);
}

bool touches(const Scene& s) { return !s.colliders.empty(); }
bool always(const Scene&) { return true; }
/// Cloth that a hand has stretched springs back when the hand releases it, and that is no fault.
bool lets_go_of_nothing(const Scene& s) { return s.grips.vertices.empty(); }
bool meets_itself(const Scene& s) { return s.needs.has(Feature::SelfCollision); }

double upper_bound(const nlohmann::json& bounds) {
  return bounds.value("at_most", std::numeric_limits<double>::infinity());
}

}  // namespace

bool has_inside(const Collider& c) { return !c.mesh || c.mesh->closed || c.mesh->skinned(); }

const std::vector<StrictBound>& strict_contact() {
  static const std::vector<StrictBound> all = {{"crossings_max", 0, touches},
                                               {"contact_length_settled_m", 0, touches},
                                               {"contact_length_max_m", 0.005, touches},
                                               {"depth_max_m", 0.001, any_collider<has_inside>},
                                               {"self_contact_length_max_m", 0, meets_itself},
                                               {"pop_max_m", 0.01, lets_go_of_nothing},
                                               {"stretch_max", 0.5, always},
                                               {"stretch_max_end", 0.05, always}};
  return all;
}

void complete_expect(nlohmann::json& expect, const Scene& scene, const std::string& source) {
  if (!expect.contains("contact")) return;
  if (scene.colliders.empty() && scene.grips.vertices.empty() && !meets_itself(scene))
    refuse(source, "/expect/contact", "\"strict\" is for scenes with colliders, grips or self_collision");
  expect.erase("contact");
  for (const StrictBound& b : strict_contact()) {
    if (!b.defined(scene)) continue;
    if (!expect.contains(b.scalar)) {
      expect[b.scalar] = {{"at_most", b.at_most}};
    } else if (!(upper_bound(expect[b.scalar]) <= b.at_most) && !expect[b.scalar].contains("why")) {
      refuse(source, std::string("/expect/") + b.scalar,
             fmt::format("\"why\", the reason for a bound looser than the strict one (at most {:g})", b.at_most));
    }
  }
}

}  // namespace clothbench
