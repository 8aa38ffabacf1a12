// A static sphere: a capsule of zero length.
#include "scenario/collider_kinds.hpp"
#include "scenario/vec3.hpp"

namespace clothbench {
namespace {

void read_sphere(const nlohmann::json& j, ColliderReader&, Collider& c) {
  c.shape = Collider::Shape::Sphere;
  c.center_m = vec3(j["center_m"]);
  c.radius_m = j["radius_m"].get<double>();
}

std::vector<Capsule> capsule_of_sphere(const Collider& c, const ColliderPose&) {
  return {{c.center_m, c.center_m, c.radius_m}};
}

}  // namespace

ColliderKind sphere_kind() {
  ColliderKind k{Collider::Shape::Sphere, "sphere", Feature::Sphere, Feature::Sphere};
  k.types = {{"sphere", read_sphere}};
  k.numbers = {{"center_m", 3, [](Collider& c) { return c.center_m.data(); }},
               {"radius_m", 1, [](Collider& c) { return &c.radius_m; }}};
  k.capsules = capsule_of_sphere;
  return k;
}

}  // namespace clothbench
