// Where the cloth ends up: how low it hangs, and whether it touches what it should lie on.
#include <limits>

#include "clothbench/vector.hpp"
#include "metrics/collider_contact.hpp"
#include "metrics/reduction.hpp"

namespace clothbench {
namespace {

bool can_lie(const Scene& s) { return kGravity.met(s) && !s.colliders.empty(); }

double lowest_height(const MetricFrame& f) {
  const Vec3& g = f.context.scene.gravity_m_per_s2;
  const double strength = length(g);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; v < f.state.position.size() / 3; ++v)
    least = -max_or_nan(-least, dot(vertex_at(f.state.position, v), g) / strength);
  return least;
}

}  // namespace

MetricGroup lying_metrics() {
  using enum Expect;
  return {{{"lowest_height_m", "m", "height of the lowest vertex above the origin, against gravity",
            Needs{"colliders, gravity", can_lie}, lowest_height}},
          {{"lowest_height_min_m", least("lowest_height_m"), Yes},
           {"touching_fraction_end", last("touching_fraction"), Yes}}};
}

}  // namespace clothbench
