#include <cmath>

#include "metrics/metric.hpp"

namespace clothbench {

double momentum_error(const MetricContext& c, int frame, const ClothState& state) {
  const Scene& s = c.scene;
  const std::vector<double> mass = vertex_masses(s);
  const Vec3 g = s.gravity_m_per_s2;
  const double t = frame * s.time.dt();
  double total = 0;
  Vec3 excess{};
  for (std::size_t v = 0; v < mass.size(); ++v) {
    total += mass[v];
    for (std::size_t k = 0; k < 3; ++k)
      excess[k] += mass[v] * (state.velocity[3 * v + k] - s.cloth.initial_velocity_m_per_s[k] - g[k] * t);
  }
  const double length = s.cloth.width_m < s.cloth.height_m ? s.cloth.height_m : s.cloth.width_m;
  return norm(excess[0], excess[1], excess[2]) / (total * std::sqrt(norm(g[0], g[1], g[2]) * length));
}

double speed_max(const MetricContext&, int, const ClothState& state) {
  double most = 0;
  for (std::size_t v = 0; v < state.velocity.size(); v += 3) {
    const double speed = norm(state.velocity[v], state.velocity[v + 1], state.velocity[v + 2]);
    most = max_or_nan(most, speed);
  }
  return most;
}

}  // namespace clothbench
