#include "metrics/metric.hpp"

namespace clothbench {
namespace {

bool always(const Scene&) { return true; }

bool falls_freely(const Scene& s) {
  return s.pins.vertices.empty() && (s.needs & kColliderFeatures).empty() && s.gravity_m_per_s2 != Vec3{};
}

bool keeps_momentum(const Scene& s) { return falls_freely(s) && !s.needs.has(Feature::Damping); }

}  // namespace

const std::vector<Metric>& metrics() {
  static const std::vector<Metric> all = {
      {"free_fall_error", "1", "greatest distance from free fall over g T^2 / 2", falls_freely, free_fall_error_max},
      {"free_fall_error_rms", "1", "root mean square distance from free fall over g T^2 / 2", falls_freely, free_fall_error_rms},
      {"stretch_max", "1", "greatest strain of the structural edges", always, stretch_max},
      {"stretch_rms", "1", "root mean square strain of the structural edges", always, stretch_rms},
      {"stretch_mean", "1", "mean strain of the structural edges", always, stretch_mean},
      {"momentum_error", "1", "momentum beside gravity's share, over M sqrt(g L)", keeps_momentum, momentum_error},
      {"speed_max", "m s-1", "greatest vertex speed", always, speed_max},
  };
  return all;
}

}  // namespace clothbench
