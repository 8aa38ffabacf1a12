#include <cmath>

#include "clothbench/record.hpp"
#include "metrics/metric.hpp"

namespace clothbench {
namespace {

/// Squared distance of every vertex from the integrator's own fall, over (|g| T^2 / 2)^2. Gravity may point anywhere;
/// the integrator's fall is given along y and scaled.
template <class Fold>
double fold_errors(const MetricContext& c, int frame, const ClothState& state, Fold fold) {
  if (frame == 0) return kMissing;
  const Scene& s = c.scene;
  const double t = frame * s.time.dt();
  const Vec3 g = s.gravity_m_per_s2;
  const double scale = 0.5 * norm(g[0], g[1], g[2]) * t * t;
  const double share = c.entry.free_fall_m(s, c.settings, frame) / g[1];
  const std::vector<double> start = initial_positions(s);
  double result = 0;
  for (std::size_t v = 0; v < start.size(); v += 3) {
    double d2 = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double expected = start[v + k] + s.cloth.initial_velocity_m_per_s[k] * t + share * g[k];
      const double d = (state.position[v + k] - expected) / scale;
      d2 += d * d;
    }
    result = fold(result, d2);
  }
  return result;
}

}  // namespace

double free_fall_error_max(const MetricContext& c, int frame, const ClothState& state) {
  return std::sqrt(fold_errors(c, frame, state, max_or_nan));
}

double free_fall_error_rms(const MetricContext& c, int frame, const ClothState& state) {
  const auto n = static_cast<double>(c.scene.cloth.vertex_count());
  return std::sqrt(fold_errors(c, frame, state, [](double a, double b) { return a + b; }) / n);
}

}  // namespace clothbench
