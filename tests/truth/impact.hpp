#pragma once

namespace clothbench::truth {

/// A cloth falls flat from rest through `height` h onto a plane and bounces with restitution e. It makes contact after
/// sqrt(2h/g) at speed sqrt(2gh). The k-th rebound rises to e^{2k} h and lasts e^k times 2 sqrt(2h/g). It comes to rest
/// at sqrt(2h/g)(1 + e)/(1 - e). At rest the plane carries M g for a mass M. Source: Newton's law of impact. Valid for
/// h > 0, g > 0, 0 <= e <= 1 (e = 1: never rests); Error otherwise. Errors of rounding only.
struct Drop {
  double height_m = 0.3;
  double restitution = 0;
  double gravity_m_per_s2 = 9.81;
};

double contact_time_s(const Drop&);
double contact_speed_m_per_s(const Drop&);
double rebound_height_m(const Drop&, int bounce);  ///< bounce >= 1
double rest_time_s(const Drop&);                   ///< infinite for e = 1
double height_above_plane_m(const Drop&, double time_s);

}  // namespace clothbench::truth
