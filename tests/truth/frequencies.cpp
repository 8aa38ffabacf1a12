#include "frequencies.hpp"

#include <Eigen/Eigenvalues>
#include <boost/math/special_functions/bessel.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <numbers>

#include "clothbench/error.hpp"
#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

using std::numbers::pi;

double wave_speed(double tension, double areal_density) {
  return std::sqrt(positive(tension, "tension_N_per_m") / positive(areal_density, "areal_density_kg_per_m2"));
}

void check_mode(int mode, int most, const char* what) {
  at_least(mode, 1, "mode");
  if (mode > most) throw Error(std::string("argument mode: expected at most ") + std::to_string(most) + " for " + what);
}

}  // namespace

double hanging_strip_frequency(int mode, double length, double gravity) {
  at_least(mode, 1, "mode");
  return 0.5 * boost::math::cyl_bessel_j_zero(0.0, mode) *
         std::sqrt(positive(gravity, "gravity_m_per_s2") / positive(length, "length_m"));
}

double hanging_chain_frequency(int mode, int links, double length, double gravity, double end_mass_ratio) {
  at_least(links, 1, "links");
  check_mode(mode, links, "this number of links");
  positive(end_mass_ratio, "end_mass_ratio");
  // m_i x_i'' = T_{i+1} (x_{i+1} - x_i)/a - T_i (x_i - x_{i-1})/a, T_i = g * (mass from i down); unit inner mass, a, g.
  Eigen::VectorXd diagonal(links), off(std::max(links - 1, 1));
  const auto tension = [&](int link) { return link < links ? links - 1 - link + end_mass_ratio : 0.0; };
  const auto mass = [&](int node) { return node + 1 < links ? 1.0 : end_mass_ratio; };
  for (int i = 0; i < links; ++i) {
    diagonal(i) = (tension(i) + tension(i + 1)) / mass(i);
    if (i + 1 < links) off(i) = -tension(i + 1) / std::sqrt(mass(i) * mass(i + 1));
  }
  if (links == 1) return std::sqrt(positive(gravity, "gravity_m_per_s2") / positive(length, "length_m"));
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, off, Eigen::EigenvaluesOnly);
  return std::sqrt(solver.eigenvalues()(mode - 1) * links * positive(gravity, "gravity_m_per_s2") /
                   positive(length, "length_m"));
}

double taut_string_frequency(int mode, double length, double tension, double areal_density) {
  return at_least(mode, 1, "mode") * pi / positive(length, "length_m") * wave_speed(tension, areal_density);
}

double taut_chain_frequency(int mode, int cells, double length, double tension, double areal_density) {
  at_least(cells, 2, "cells");
  check_mode(mode, cells - 1, "this number of cells");
  return 2 * cells / positive(length, "length_m") * wave_speed(tension, areal_density) *
         std::sin(mode * pi / (2 * cells));
}

double membrane_frequency(int mode_a, int mode_b, double side_a, double side_b, double tension, double areal_density) {
  return pi * wave_speed(tension, areal_density) *
         std::hypot(at_least(mode_a, 1, "mode_a") / positive(side_a, "side_a_m"),
                    at_least(mode_b, 1, "mode_b") / positive(side_b, "side_b_m"));
}

double membrane_sag_m(double side_a, double side_b, double tension, double areal_density, double gravity) {
  positive(side_a, "side_a_m");
  positive(side_b, "side_b_m");
  // (4 k a^2/pi^3) sum over odd n of (-1)^((n-1)/2) (1 - sech(n pi b/2a))/n^3, k = rho g/T. The part without sech sums
  // to pi^3/32, so that what is left falls exponentially; a is the shorter side to make it fall fast.
  const double a = std::min(side_a, side_b), b = std::max(side_a, side_b);
  double sum = pi * pi * pi / 32;
  for (int n = 1, sign = 1; n < 60; n += 2, sign = -sign) sum -= sign / (n * n * n * std::cosh(n * pi * b / (2 * a)));
  return positive(areal_density, "areal_density_kg_per_m2") * positive(gravity, "gravity_m_per_s2") /
         positive(tension, "tension_N_per_m") * 4 * a * a / (pi * pi * pi) * sum;
}

double cantilever_root(int mode) {
  at_least(mode, 1, "mode");
  // cos(b) + 1/cosh(b) changes sign once between neighbouring multiples of pi, and nothing overflows.
  std::uintmax_t iterations = 200;
  const auto bracket = boost::math::tools::toms748_solve([](double b) { return std::cos(b) + 1 / std::cosh(b); },
                                                         (mode - 1) * pi + (mode == 1 ? 0.1 : 0.0), mode * pi,
                                                         boost::math::tools::eps_tolerance<double>(52), iterations);
  return 0.5 * (bracket.first + bracket.second);
}

double cantilever_frequency(int mode, double length, double bending_rigidity, double areal_density) {
  const double per_length = cantilever_root(mode) / positive(length, "length_m");
  return per_length * per_length *
         std::sqrt(positive(bending_rigidity, "bending_rigidity_N_m") /
                   positive(areal_density, "areal_density_kg_per_m2"));
}

EulerDamping implicit_euler_damping(double frequency, double step) {
  const double z = positive(frequency, "frequency_rad_per_s") * positive(step, "step_s");
  const double turn = std::atan(z);
  return {1 / std::hypot(1.0, z), turn / z, std::exp(-pi / turn * std::log1p(z * z))};
}

}  // namespace clothbench::truth
