#pragma once

#include "truth/discrete_elastica.hpp"

namespace clothbench::truth {

/// Gamma = rho g L^3/B at which a strip clamped upright buckles: theta'' + Gamma (1 - s) theta = 0, so Gamma_c = (9/4)
/// j^2 with j the first zero of J_{-1/3}; 7.837347. Source: Greenhill 1881; Timoshenko & Gere, Theory of Elastic
/// Stability, ch. 2. Errors of rounding only.
double self_buckling_own_weight();

/// The same for a chain of `links` free rigid links with lumped rows (least eigenvalue; both bending models agree
/// there). Order 2 in 1/links with ClampHinge::HalfCell. Relative error 1e-12 * links. Throws Error for links < 1.
double discrete_self_buckling_own_weight(int links, ClampHinge = ClampHinge::HalfCell);

}  // namespace clothbench::truth
