#pragma once
#include <array>

namespace clothbench::truth {

/// A strip that spins about its middle without gravity, as springs along its length with engineering strain (tension
/// Y (dr/dX - 1)): Y r'' = -rho w^2 r, r(0) = 0, r'(l) = 1, so
///   r(X) = sin(kX) / (k cos(k l)),   k = w sqrt(rho / Y),   tip radius tan(k l)/k.
/// A run that starts from this shape rotates rigidly. Inextensible: r = X. Source: balance of tension and centripetal
/// force on a rotating bar. Valid for k l < pi/2 (beyond, no steady shape exists); throws Error otherwise or for a
/// value that is not positive. Errors of rounding only.
struct SpinningStrip {
  double half_length_m = 0.5;
  double areal_density_kg_per_m2 = 0.2;
  double membrane_stiffness_N_per_m = 1000;
  double angular_speed_rad_per_s = 1;
};

/// Radius [m] of the point with rest radius X [m], |X| <= half length.
double spin_radius_m(const SpinningStrip&, double rest_radius_m);
double spin_strain(const SpinningStrip&, double rest_radius_m);

/// Position after `time_s` of a point (x, y) of a rigid body that rotates about the origin.
std::array<double, 2> rotated(std::array<double, 2> start_m, double angular_speed_rad_per_s, double time_s);

}  // namespace clothbench::truth
