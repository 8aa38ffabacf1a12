#pragma once
#include <array>
#include <span>
#include <vector>

namespace clothbench::truth {

/// A straight strip of inextensible links without bending stiffness, held at one end and released at rest; it swings in
/// a vertical plane under gravity. It is the truth at equal resolution for an inextensible cloth strip with nodal
/// masses.
///
/// Coordinates are the link angles, so that the links are exactly of constant length. Tensions T_j follow from
/// |r_j - r_{j-1}| = a differentiated twice, with c_j = cos(theta_{j+1} - theta_j):
///   T_j (1/m_j + 1/m_{j-1}) - T_{j+1} c_j/m_j - T_{j-1} c_{j-1}/m_{j-1} = a theta_j'^2,
///   a theta_j'' = T_{j+1} sin(theta_{j+1} - theta_j)/m_j + T_{j-1} sin(theta_{j-1} - theta_j)/m_{j-1},
/// where for j = 1 the terms with m_0 are instead + g sin(theta_1) and + g cos(theta_1) on the right.
/// Source: Newton's second law with Lagrange multipliers (e.g. Goldstein, Classical Mechanics, ch. 2). Integrated by
/// Boost.Odeint (Runge-Kutta-Fehlberg 7(8), adaptive).
///
/// Valid at any time as the truth of the chain. A strip released from the horizontal contracts perturbations until 0.5
/// s * sqrt(L/1 m * 9.81/g) and is chaotic afterwards: compare positions only up to then. The error of the positions is
/// below 1e-10 L at the default tolerance until then, and grows with the perturbations afterwards.
struct SwingingChain {
  int links = 32;
  double length_m = 1;
  double gravity_m_per_s2 = 9.81;
  double end_mass_ratio = 0.5;  ///< mass of the free end row over that of an inner row: 1/2 for cells' lumped masses
  double start_angle_rad = 0;   ///< below the horizontal
};

/// Nodes from the held end (index 0) to the free one; x horizontal, z upwards, from the held end. Lengths links + 1.
struct ChainState {
  double time_s = 0;
  std::vector<double> x_m, z_m, x_speed_m_per_s, z_speed_m_per_s;
};

/// States at `times_s` (ascending, 0 or more). `tolerance`: error per step, absolute and relative, of angles and
/// angular speeds in units of sqrt(g/L). Throws Error for bad arguments or if the integrator can't make progress.
std::vector<ChainState> swing(const SwingingChain&, std::span<const double> times_s, double tolerance = 1e-13);

/// Linear interpolation between the nodes, at a share 0 .. 1 of the strip's length from the held end: position {x, z}
/// of the material point. Throws Error for another share.
std::array<double, 2> chain_position_m(const ChainState&, double share);

}  // namespace clothbench::truth
