#pragma once

namespace clothbench::truth {

/// An inextensible strip of length L slides without friction over a fixed horizontal cylinder, both ends hanging,
/// released with its middle displaced by s0 along the strip: L s'' = 2 g s, so s = s0 cosh(sqrt(2g/L) t). Source:
/// Lagrange's equation (the part on the cylinder neither gains nor loses height). Valid while the light end hangs and
/// the strip stays in contact with the cylinder, N >= 0: l1 (g + s'') >= s'^2 where the light side meets it (derived
/// from the balance there; elsewhere N is greater). `atwood_end_s` is the time at which the first of these conditions
/// fails. Throws Error for later times, values that are not positive, and overhangs that do not fit (2 s0 + pi R < L
/// needed). Errors of rounding only.
struct Atwood {
  double length_m = 1;
  double radius_m = 0.05;
  double offset_m = 0.05;  ///< s0: half the difference of the overhangs
  double gravity_m_per_s2 = 9.81;
};

double atwood_end_s(const Atwood&);
double atwood_offset_m(const Atwood&, double time_s);
double atwood_speed_m_per_s(const Atwood&, double time_s);

}  // namespace clothbench::truth
