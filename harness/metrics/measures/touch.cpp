// Contact without penetration: how much of the cloth touches, how far it slides, how low it hangs.
#include <algorithm>
#include <limits>

#include "metrics/collider_contact.hpp"
#include "metrics/registry.hpp"

namespace clothbench {
namespace {

bool can_rest(const Scene& s) { return kGravity.met(s) && !s.colliders.empty(); }

bool has_friction(const Scene& s) {
  return kWithContactMetrics &&
         std::any_of(s.colliders.begin(), s.colliders.end(), [](const Collider& c) { return c.friction > 0; });
}

double lowest_height(const MetricFrame& f) {
  const Vec3& g = f.context.scene.gravity_m_per_s2;
  const double strength = length(g);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; v < f.state.position.size() / 3; ++v)
    least = -max_or_nan(-least, dot(vertex_at(f.state.position, v), g) / strength);
  return least;
}

}  // namespace

MetricGroup touch_metrics() {
  using enum Expect;
  static constexpr Gate kSlip{1e-2, SlackUnit::Length, 0.5, false, "a fold that slides elsewhere"};
  constexpr Needs kFriction{"friction", has_friction}, kRest{"colliders, gravity", can_rest};
  return {
      {{"touching_fraction", "1", "fraction of the cloth's area in contact with a collider", kColliders,
        [](const MetricFrame& f) { return f.touch->touching_fraction; }},
       {"slip_m", "m", "mean displacement along the surface of vertices in contact, per frame", kFriction,
        [](const MetricFrame& f) { return f.touch->slip_m; }},
       {"lowest_height_m", "m", "height of the lowest vertex above the origin, against gravity", kRest, lowest_height}},
      {{.name = "touching_fraction_end", .from = last("touching_fraction"), .expect = Yes, .better = Better::More},
       {"slip_m", sum("slip_m"), Yes, &kSlip},
       {.name = "lowest_height_min_m", .from = least("lowest_height_m"), .expect = Yes, .better = Better::More}}};
}

}  // namespace clothbench
