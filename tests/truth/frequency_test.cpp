#include <boost/math/special_functions/laguerre.hpp>
#include <numbers>

#include "frequencies.hpp"
#include "printed_table.hpp"

namespace clothbench::truth {
namespace {

TEST(Frequencies, HangingStrip) {
  // Half the zeros of J0 (Abramowitz & Stegun, table 9.5).
  EXPECT_NEAR(hanging_strip_frequency(1, 1, 1), 1.202413, 5e-7);
  EXPECT_NEAR(hanging_strip_frequency(2, 1, 1), 2.760039, 5e-7);
  EXPECT_NEAR(hanging_strip_frequency(3, 1, 1), 4.326864, 5e-7);
  EXPECT_NEAR(hanging_strip_frequency(1, 1, 1), 1.2024127788478864, 1e-14);
  EXPECT_NEAR(2 * std::numbers::pi / hanging_strip_frequency(1, 1, 9.81), 1.668368, 5e-7);
}

TEST(Frequencies, ChainOfEqualMassesIsLaguerre) {
  for (const unsigned n : {1u, 2u, 5u, 12u})
    for (unsigned mode = 1; mode <= n; ++mode) {
      const double w = hanging_chain_frequency(static_cast<int>(mode), static_cast<int>(n), 0.3, 2, 1),
                   x = w * w * 0.3 / (2 * n);
      const double slope =
          (boost::math::laguerre(n, x * (1 + 1e-6)) - boost::math::laguerre(n, x * (1 - 1e-6))) / (2e-6 * x);
      EXPECT_NEAR(boost::math::laguerre(n, x) / slope / x, 0, 1e-9) << n << ' ' << mode;
    }
}

TEST(Frequencies, PublishedErrorsOfTheChain) {
  const auto error = [](int mode, int n, double end) {
    return hanging_chain_frequency(mode, n, 1, 1, end) / hanging_strip_frequency(mode, 1, 1) - 1;
  };
  EXPECT_NEAR(error(1, 32, 0.5), -2.9e-4, 5e-6);
  EXPECT_NEAR(error(2, 32, 0.5), -3.8e-3, 5e-5);
  EXPECT_NEAR(error(3, 32, 0.5), -1.5e-2, 5e-4);
  EXPECT_NEAR(error(1, 32, 1), -7.7e-3, 5e-5);
  EXPECT_NEAR(std::log2(error(1, 64, 0.5) / error(1, 128, 0.5)), 2, 0.05);
  EXPECT_NEAR(std::log2(error(1, 64, 1) / error(1, 128, 1)), 1, 0.05);
}

TEST(Frequencies, TautString) {
  EXPECT_NEAR(taut_string_frequency(2, 0.5, 8, 0.5), 2 * std::numbers::pi / 0.5 * 4, 1e-12);
  EXPECT_NEAR(taut_chain_frequency(2, 2000, 0.5, 8, 0.5) / taut_string_frequency(2, 0.5, 8, 0.5), 1, 1e-6);
  // Two cells: one row of mass a rho between two springs, w^2 = 2 T/(rho a^2).
  EXPECT_NEAR(taut_chain_frequency(1, 2, 1, 3, 0.5), std::sqrt(2 * 3 / (0.5 * 0.25)), 1e-12);
}

TEST(Frequencies, Membrane) {
  EXPECT_NEAR(membrane_frequency(1, 1, 0.3, 0.3, 5, 0.2) / (2 * std::numbers::pi),
              std::sqrt(0.5) * std::sqrt(5 / 0.2) / 0.3, 1e-12);
  EXPECT_NEAR(membrane_sag_m(1, 1, 1, 1, 1), 0.07367135, 5e-9);
  EXPECT_NEAR(membrane_sag_m(2, 2, 5, 0.2, 9.81), 0.07367135 * 0.2 * 9.81 * 4 / 5, 1e-7);
  EXPECT_NEAR(membrane_sag_m(1, 50, 1, 1, 1), 1.0 / 8, 1e-12);  // a strip between two walls: a parabola
  EXPECT_EQ(membrane_sag_m(1, 3, 1, 1, 1), membrane_sag_m(3, 1, 1, 1, 1));
}

TEST(Frequencies, Cantilever) {
  // Blevins, Formulas for Natural Frequency and Mode Shape, table 8-1.
  EXPECT_NEAR(cantilever_root(1), 1.875104, 5e-7);
  EXPECT_NEAR(cantilever_root(2), 4.694091, 5e-7);
  EXPECT_NEAR(cantilever_root(3), 7.854757, 5e-7);
  EXPECT_NEAR(cantilever_root(1), 1.8751040687, 5e-11);
  EXPECT_NEAR(cantilever_root(40), 39.5 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(cantilever_frequency(1, 0.5, 0.02, 0.3), 1.8751040687 * 1.8751040687 * std::sqrt(0.02 / (0.3 * 0.0625)),
              1e-8);
}

TEST(Frequencies, ImplicitEuler) {
  EXPECT_NEAR(implicit_euler_damping(1, 0.1).per_period, 0.7308, 5e-5);
  EXPECT_NEAR(implicit_euler_damping(5, 0.1).per_period, 0.2205, 5e-5);
  EXPECT_NEAR(implicit_euler_damping(10, 0.1).per_period, 0.0625, 1e-15);
  // One step on an oscillator, from (x, v) = (1, 0): x + i v/w becomes 1/(1 + i z) times as great (to within a sign).
  const double w = 3, dt = 0.2, z = w * dt, v = -w * w * dt / (1 + z * z), x = 1 + dt * v;
  const EulerDamping d = implicit_euler_damping(w, dt);
  EXPECT_NEAR(std::hypot(x, v / w), d.per_step, 1e-15);
  EXPECT_NEAR(std::atan2(-v / w, x) / z, d.frequency_ratio, 1e-15);
}

}  // namespace
}  // namespace clothbench::truth
