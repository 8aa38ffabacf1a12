#pragma once

namespace clothbench::truth {

/// A flat strip of rest length L = 2l pulled apart at both ends, without gravity, modelled as springs along its length
/// with engineering strain: u_tt = c^2 u_xx, c = sqrt(Y/rho), x from the middle. Each end moves outwards with v(t) = v0
/// sin^2(pi t/(2 Tr)) up to t = Tr and v0 after. By the method of images:
///   strain = (1/c) sum_{k>=0} [ v(t - ((2k+1)l - x)/c) + v(t - ((2k+1)l + x)/c) ],  speed = sum of differences.
/// Source: wave equation (e.g. Graff, Wave Motion in Elastic Solids, ch. 2). Exact in the continuum; the wave from each
/// end adds a strain of v0/c. A step (Tr = 0) is allowed, but is not a truth for a lattice, which overshoots it by
/// about a quarter at any resolution: use a ramp of 2 l/c or longer. Valid for any t >= 0 and |x| <= l; errors of
/// rounding. Throws Error for other arguments. A strip of infinite stiffness has the mean strain everywhere.
struct TwoHandPull {
  double length_m = 1;
  double areal_density_kg_per_m2 = 0.2;
  double membrane_stiffness_N_per_m = 1000;
  double hand_speed_m_per_s = 10;
  double ramp_s = 0;
};

double wave_speed_m_per_s(const TwoHandPull&);
double hand_way_m(const TwoHandPull&, double time_s);
double pull_displacement_m(const TwoHandPull&, double rest_x_m, double time_s);

}  // namespace clothbench::truth
