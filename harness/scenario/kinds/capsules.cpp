// Dynamic capsules: one on a path, or the capsules of a hand.
#include "scenario/collider_kinds.hpp"
#include "scenario/collider_reader.hpp"
#include "scenario/moving_hand.hpp"
#include "scenario/vec3.hpp"

namespace clothbench {
namespace {

void read_capsule(const nlohmann::json& j, ColliderReader& reader, Collider& c) {
  c.shape = Collider::Shape::Capsules;
  const Vec3 center = vec3(j["center_m"]), axis = reader.unit(j, "axis"), spin = vec3(j["spin_rad_per_s"]);
  const double length = j["length_m"].get<double>(), radius = j["radius_m"].get<double>();
  reader.pose = [=, path = reader.path(j)](double t) {
    return ColliderPose{{moved_capsule(path, center, axis, length, radius, spin, t)}, {}};
  };
  c.capsules = reader.pose(0).capsules;
}

void read_hand_capsules(const nlohmann::json& j, ColliderReader& reader, Collider& c) {
  read_hand(j, reader, c, false);
}

std::vector<Capsule> capsules_now(const Collider& c, const ColliderPose& pose) {
  return pose.capsules.empty() ? c.capsules : pose.capsules;
}

}  // namespace

ColliderKind capsules_kind() {
  ColliderKind k{Collider::Shape::Capsules, "capsules", Feature::Capsules, Feature::Capsules};
  k.types = {{"capsule", read_capsule}, {"hand_capsules", read_hand_capsules}};
  k.holds = ColliderKind::Holds::Capsules;
  k.capsules = capsules_now;
  return k;
}

}  // namespace clothbench
