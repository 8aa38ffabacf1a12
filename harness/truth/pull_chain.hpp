#pragma once
#include <span>
#include <vector>

namespace clothbench::truth {

/// A straight chain of n equal springs with lumped masses (half a cell's at the ends), without gravity, whose two ends
/// are moved along it. It is the truth at equal resolution for a strip pulled by hands, with engineering strain
///   x_i'' = (c/a)^2 (x_{i+1} - 2 x_i + x_{i-1}),  c = sqrt(Y/rho),  a = L/n.
/// Source: Newton's second law; exact as long as every spring stays along the line. Integrated by Boost.Odeint
/// (Runge-Kutta-Fehlberg 7(8), adaptive).
struct PulledChain {
  int links = 32;
  double length_m = 1;
  double areal_density_kg_per_m2 = 0.2;
  double membrane_stiffness_N_per_m = 1000;
};

/// Displacement [m] and speed [m/s] of all links + 1 nodes; an end's speed is that of the preceding segment.
struct PulledState {
  double time_s = 0;
  std::vector<double> displacement_m, speed_m_per_s;
};

/// States at `times_s` (ascending from 0). The ends have the given displacements at these times and move linearly
/// between them. Starts at rest. Errors below 1e-10 L at the default tolerance (absolute, in units of the length).
/// Throws Error for bad arguments or if the integrator fails to advance.
std::vector<PulledState> pull(const PulledChain&, std::span<const double> times_s, std::span<const double> first_m,
                              std::span<const double> last_m, double tolerance = 1e-13);

}  // namespace clothbench::truth
