#include <cmath>

#include "metrics/registry.hpp"

namespace clothbench {
namespace {

/// Displacement of a freely falling body under the solver's integrator. Its law is the same in every direction, so the
/// solver declares only the vertical one, and each component is computed as if vertical.
Vec3 fall(const MetricContext& c, int frame) {
  Scene body;
  body.cloth = c.scene.cloth;
  body.material = c.scene.material;
  body.time = c.scene.time;
  body.needs = c.scene.needs;
  Vec3 way{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double g = c.scene.gravity_m_per_s2[k], v = c.scene.cloth.initial_velocity_m_per_s[k];
    if (g == 0 && v == 0) continue;
    body.gravity_m_per_s2 = {0, g, 0};
    body.cloth.initial_velocity_m_per_s = {0, v, 0};
    way[k] = c.entry.free_fall_m(body, c.settings, frame);
  }
  return way;
}

/// Largest distance of a vertex's vector from the exact one, over `scale`; `exact(v, k)`: component k of vertex v.
template <class Exact>
double greatest_error(const std::vector<double>& values, double scale, Exact exact) {
  double most = 0;
  for (std::size_t v = 0; v < values.size(); v += 3) {
    double squared = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double d = (values[v + k] - exact(v + k, k)) / scale;
      squared += d * d;
    }
    most = max_or_nan(most, squared);
  }
  return std::sqrt(most);
}

/// Largest distance of a vertex from the integrator's free fall, divided by |g| T^2 / 2; NaN at T = 0.
double free_fall_error(const MetricFrame& f) {
  if (f.index == 0) return kMissing;
  const Scene& s = f.context.scene;
  const double t = s.time.at(f.index);
  const Vec3 g = s.gravity_m_per_s2, way = fall(f.context, f.index);
  const std::vector<double> start = initial_positions(s);
  return greatest_error(f.state.position, 0.5 * length(g) * t * t,
                        [&](std::size_t i, std::size_t k) { return start[i] + way[k]; });
}

/// Largest error of a vertex's velocity in free fall without damping, divided by |g| T; NaN at T = 0. All common
/// integrators are exact here, so an error shows velocities that do not match the motion.
double free_fall_velocity_error(const MetricFrame& f) {
  if (f.index == 0) return kMissing;
  const Scene& s = f.context.scene;
  const double t = s.time.at(f.index);
  return greatest_error(f.state.velocity, length(s.gravity_m_per_s2) * t, [&](std::size_t, std::size_t k) {
    return s.cloth.initial_velocity_m_per_s[k] + s.gravity_m_per_s2[k] * t;
  });
}

/// Integrators declare their free fall only for frames of equal length.
bool falls_freely(const Scene& s) {
  return touches_nothing(s) && kGravity.met(s) && s.time.ends_s.empty() && s.cloth.spin_rad_per_s == Vec3{};
}

}  // namespace

MetricGroup free_fall_metrics() {
  constexpr Needs kFree{"free cloth, gravity", falls_freely};
  constexpr Needs kUndamped{"free cloth, gravity, no damping",
                            [](const Scene& s) { return falls_freely(s) && s.material.damping_per_s == 0; }};
  return {{{"free_fall_error", "1", "maximum distance from free fall, divided by g T^2 / 2", kFree, free_fall_error},
           {"free_fall_velocity_error", "1", "maximum error of a velocity in free fall, divided by g T", kUndamped,
            free_fall_velocity_error}},
          {{"free_fall_error", last("free_fall_error"), Expect::Yes, &kErrorGate},
           {"free_fall_velocity_error", last("free_fall_velocity_error"), Expect::Yes, &kErrorGate}}};
}

}  // namespace clothbench
