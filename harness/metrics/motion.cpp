#include <algorithm>
#include <cmath>

#include "clothbench/vector.hpp"
#include "metrics/registry.hpp"

namespace clothbench {
namespace {

bool keeps_momentum(const Scene& s) {
  const bool has_scale = kGravity.met(s) || s.cloth.initial_velocity_m_per_s != Vec3{};
  return touches_nothing(s) && !s.needs.has(Feature::Damping) && has_scale;
}

/// |P - P0 - M g t| / (M (sqrt(|g| L) + |v0|)), L the longer side, v0 the initial velocity.
double momentum_error(const MetricFrame& f) {
  const Scene& s = f.context.scene;
  const std::vector<double> mass = vertex_masses(s);
  const Vec3 g = s.gravity_m_per_s2, v0 = s.cloth.initial_velocity_m_per_s;
  const double t = s.time.at(f.index);
  double total = 0;
  Vec3 excess{};
  for (std::size_t v = 0; v < mass.size(); ++v) {
    total += mass[v];
    for (std::size_t k = 0; k < 3; ++k) excess[k] += mass[v] * (f.state.velocity[3 * v + k] - v0[k] - g[k] * t);
  }
  const double speed = std::sqrt(length(g) * std::max(s.cloth.width_m, s.cloth.height_m)) + length(v0);
  return length(excess) / (total * speed);
}

double speed_max(const MetricFrame& f) {
  double most = 0;
  for (std::size_t v = 0; v < f.state.velocity.size() / 3; ++v)
    most = max_or_nan(most, length(vertex_at(f.state.velocity, v)));
  return most;
}

double kinetic_energy(const MetricFrame& f) {
  const std::vector<double> mass = vertex_masses(f.context.scene);
  double energy = 0;
  for (std::size_t k = 0; k < f.state.velocity.size(); ++k)
    energy += 0.5 * mass[k / 3] * f.state.velocity[k] * f.state.velocity[k];
  return energy;
}

double gravity_energy(const MetricFrame& f) {
  const std::vector<double> mass = vertex_masses(f.context.scene), start = initial_positions(f.context.scene);
  double energy = 0;
  for (std::size_t k = 0; k < start.size(); ++k)
    energy -= mass[k / 3] * f.context.scene.gravity_m_per_s2[k % 3] * (f.state.position[k] - start[k]);
  return energy;
}

}  // namespace

MetricGroup motion_metrics() {
  constexpr Needs kFree{"free cloth without damping", keeps_momentum};
  return {{{"momentum_error", "1", "momentum beside gravity's share, over M (sqrt(g L) + v0)", kFree, momentum_error},
           {"speed_max", "m s-1", "greatest vertex speed", kAlways, speed_max},
           {"kinetic_energy_J", "J", "kinetic energy", kAlways, kinetic_energy},
           {"gravity_energy_J", "J", "work done against gravity since the start", kGravity, gravity_energy}},
          {}};
}

}  // namespace clothbench
