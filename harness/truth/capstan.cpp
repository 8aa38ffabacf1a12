#include "truth/capstan.hpp"

#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <numbers>

#include "clothbench/error.hpp"
#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

using std::numbers::pi;

double check(const HeavyCapstan& c) {
  non_negative(c.friction, "friction");
  non_negative(c.radius_m, "radius_m");
  return positive(c.areal_density_kg_per_m2, "areal_density_kg_per_m2") *
         positive(c.gravity_m_per_s2, "gravity_m_per_s2");
}

double half_turn(double friction, double wrap, int turns) {
  const double half = non_negative(wrap, "wrap_rad") / (2 * at_least(turns, 1, "turns"));
  between(half, -1, pi / 2, "wrap_rad (per turn, half)");
  within(non_negative(friction, "friction") * std::tan(half), 0, std::nextafter(1.0, 0.0),
         "friction (times tan of half a turn)");
  return half;
}

}  // namespace

double capstan_ratio(double friction, double wrap) {
  return std::exp(non_negative(friction, "friction") * non_negative(wrap, "wrap_rad"));
}

double slip_tension_N_per_m(const HeavyCapstan& c, double light, double phi) {
  const double weight = check(c) * c.radius_m, mu = c.friction;
  non_negative(light, "light_tension_N_per_m");
  within(phi, 0, pi, "phi_rad");
  // Particular solution A sin + B cos of the linear equation.
  const double a = weight * (1 - mu * mu) / (1 + mu * mu), b = -2 * mu * weight / (1 + mu * mu);
  return std::exp(mu * phi) * (light - b) + a * std::sin(phi) + b * std::cos(phi);
}

double greatest_tension_N_per_m(const HeavyCapstan& c, double light) { return slip_tension_N_per_m(c, light, pi); }

double greatest_overhang_m(const HeavyCapstan& c, double light_overhang) {
  const double weight = check(c);
  return greatest_tension_N_per_m(c, weight * non_negative(light_overhang, "light_overhang_m")) / weight;
}

bool holds(const HeavyCapstan& c, double overhang_1, double overhang_2) {
  return overhang_2 <= greatest_overhang_m(c, overhang_1) && overhang_1 <= greatest_overhang_m(c, overhang_2);
}

double polygonal_greatest_overhang_m(const HeavyCapstan& c, double light_overhang, int turns) {
  check(c);
  const double half = half_turn(c.friction, pi, turns), mu = c.friction;
  const double edge = 2 * c.radius_m * std::sin(half), in = std::cos(half) + mu * std::sin(half),
               out = std::cos(half) - mu * std::sin(half);
  double tension = non_negative(light_overhang, "light_overhang_m");  // over rho g
  for (int j = 0; j < turns; ++j) {
    const double phi = (2 * j + 1) * half;
    tension = (tension * in + edge * (std::cos(phi) + mu * std::sin(phi))) / out;
  }
  return tension;
}

std::vector<SlidState> slide(const HeavyCapstan& c, double overhang_1, double overhang_2, int turns,
                             std::span<const double> times_s) {
  namespace odeint = boost::numeric::odeint;
  using State = std::array<double, 2>;
  check(c);
  const auto greatest = [&](double light) {
    return turns > 0 ? polygonal_greatest_overhang_m(c, light, turns) : greatest_overhang_m(c, light);
  };
  const double mu = c.friction, constant = greatest(0), ratio = (greatest(1) - constant),
               smooth = capstan_ratio(mu, pi);
  const double on_cylinder = mu > 0 ? c.radius_m * (smooth - 1) / mu : pi * c.radius_m;
  const auto rate = [&](const State& x, State& d, double) {
    const double light = overhang_1 - x[0], heavy = overhang_2 + x[0];
    d[0] = x[1];
    d[1] = (c.gravity_m_per_s2 * (heavy - ratio * light - constant) + x[1] * x[1] * (ratio - 1)) /
           (heavy + ratio * light + on_cylinder);
  };
  if (overhang_1 > greatest(overhang_2)) throw Error("argument overhang_1_m: expected the light side");
  const bool still = overhang_2 <= greatest(overhang_1);
  State x = {0, 0};
  std::vector<SlidState> out;
  double now = 0;
  for (const double t : times_s) {
    if (!(t >= now)) throw Error("argument times_s: expected ascending times from 0");
    if (!still && t > now)
      odeint::integrate_adaptive(odeint::make_controlled(1e-12, 1e-12, odeint::runge_kutta_fehlberg78<State>()), rate,
                                 x, now, t, (t - now) / 4);
    if (!(x[0] < overhang_1)) throw Error("argument times_s: expected times before the light end reaches the cylinder");
    now = t;
    out.push_back({t, x[0], x[1]});
  }
  return out;
}

}  // namespace clothbench::truth
