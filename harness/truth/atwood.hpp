#pragma once

namespace clothbench::truth {

/// An inextensible strip of length L that slides without friction over a fixed horizontal cylinder, both ends hanging,
/// let go with its middle displaced by s0 along itself: L s'' = 2 g s, so s = s0 cosh(sqrt(2g/L) t). Source: Lagrange's
/// equation (the part on the cylinder neither gains nor loses height). Valid while the light end hangs and the strip
/// keeps to the cylinder, N >= 0: l1 (g + s'') >= s'^2 at the point where the light side meets it (derived from the
/// balance there; elsewhere N is greater). `atwood_end_s` is when the first of the two fails; later times throw Error,
/// as do a value not positive or overhangs that don't fit (2 s0 + pi R < L needed). Errors of rounding only.
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
