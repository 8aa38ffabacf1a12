#include <numbers>

#include "printed_table.hpp"
#include "pull_strain.hpp"
#include "stretch_laws.hpp"
#include "sudden_gravity.hpp"

namespace clothbench::truth {
namespace {

HeavyStrip strip(double eps) { return {2, 0.25, 0.25 * 4 * 2 / eps, 4, 0}; }

TEST(HeavyStretch, PublishedRows) {
  const PrintedTable table("heavy_stretch.csv");
  for (const auto& row : table.rows()) {
    const std::pair<const char*, StretchLaw> laws[] = {{"engineering", StretchLaw::EngineeringSpring},
                                                       {"stvk", StretchLaw::StVenantKirchhoff},
                                                       {"neo_hooke", StretchLaw::NeoHookeIncompressible}};
    for (const auto& [name, law] : laws) {
      const HeavyStrip s = strip(row.at("eps"));
      // The table lost digits in lambda - 1: at eps = 1e-6 it differs by 5e-14 from the series eps/2 -+ eps^2/2.
      table.expect(hang_displacement_m(s, 2, law) / 2, row.at(name), row_text(row), 1e-13);
    }
    table.expect(hang_displacement_m(strip(row.at("eps")), 2) / 2, row.at("engineering"), row_text(row), 1e-13);
    table.expect(hang_strain(strip(row.at("eps")), 0, StretchLaw::EngineeringSpring), row.at("greatest_strain"),
                 row_text(row));
  }
  // rho g L^2/2Y of a typical shirt fabric, 1 m long.
  EXPECT_NEAR(hang_displacement_m({}, 1), 0.981e-3, 1e-15);
}

TEST(HeavyStretch, StrainIsTheSlopeAndCarriesTheTension) {
  for (const auto law :
       {StretchLaw::EngineeringSpring, StretchLaw::StVenantKirchhoff, StretchLaw::NeoHookeIncompressible}) {
    const HeavyStrip s{1.5, 0.3, 20, 9.81, 7};
    EXPECT_EQ(hang_displacement_m(s, 0, law), 0);
    for (const double at : {0.2, 0.9, 1.4}) {
      const double h = 1e-5,
                   slope = (hang_displacement_m(s, at + h, law) - hang_displacement_m(s, at - h, law)) / (2 * h);
      EXPECT_NEAR(slope, hang_strain(s, at, law), 1e-8);
      if (law == StretchLaw::EngineeringSpring) {
        EXPECT_NEAR(hang_displacement_m(s, at), hang_displacement_m(s, at, law), 1e-13);
      }
    }
    const double e = hang_strain(s, 0.4, law), l = 1 + e, t = hang_tension_N_per_m(s, 0.4) / 20;
    EXPECT_NEAR(t, (0.3 * 9.81 * 1.1 + 7) / 20, 1e-14);
    const double law_value = law == StretchLaw::EngineeringSpring   ? e
                             : law == StretchLaw::StVenantKirchhoff ? l * (l * l - 1) / 2
                                                                    : (l - 1 / (l * l)) / 3;
    EXPECT_NEAR(law_value, t, 1e-13);
  }
}

TEST(HeavyStretch, RowsOfSprings) {
  const HeavyStrip s{1.5, 0.3, 200, 9.81, 7};
  for (const int n : {1, 7, 32})
    for (int row = 0; row <= n; ++row)
      EXPECT_NEAR(hang_row_displacement_m(s, n, row), hang_displacement_m(s, 1.5 * row / n), 1e-14);
}

TEST(SuddenGravity, TipAgainstItsPieces) {
  const SuddenGravity s{};  // c = 70.71 m/s
  const double c = std::sqrt(5000.0), g = 9.81;
  EXPECT_NEAR(sudden_gravity_period_s(s), 56.57e-3, 5e-6);
  EXPECT_NEAR(sudden_gravity_displacement_m(s, 1, 2 / c), 1.962e-3, 1e-15);
  for (const double crossings : {0.3, 0.99, 1.01, 1.7, 2.9, 4.3, 7.2}) {
    const double t = crossings / c, p = std::fmod(crossings, 4) / c;
    const double late = std::max(0.0, p - 1 / c), last = std::max(0.0, p - 3 / c);
    EXPECT_NEAR(sudden_gravity_displacement_m(s, 1, t), 0.5 * g * p * p - g * late * late + g * last * last, 1e-16);
  }
}

TEST(SuddenGravity, SolvesTheWaveEquationWithItsEnds) {
  const SuddenGravity s{0.7, 0.3, 40, 3};
  const double h = 1e-5, k = 1e-6, c2 = 40 / 0.3;
  for (const double t : {0.01, 0.08, 0.15, 0.2, 1.234}) {
    for (const double x : {0.13, 0.42}) {
      const auto u = [&](double dx, double dt) { return sudden_gravity_displacement_m(s, x + dx, t + dt); };
      const double tt = (u(0, k) - 2 * u(0, 0) + u(0, -k)) / (k * k), xx = (u(h, 0) - 2 * u(0, 0) + u(-h, 0)) / (h * h);
      EXPECT_NEAR(tt, c2 * xx + 3, 1e-2);
      EXPECT_NEAR(sudden_gravity_speed_m_per_s(s, x, t), (u(0, k) - u(0, -k)) / (2 * k), 1e-8);
      EXPECT_NEAR(sudden_gravity_strain(s, x, t), (u(h, 0) - u(-h, 0)) / (2 * h), 1e-9);
    }
    EXPECT_NEAR(sudden_gravity_displacement_m(s, 0, t), 0, 1e-15);
    EXPECT_NEAR(sudden_gravity_strain(s, 0.7, t), 0, 1e-15);
  }
}

TEST(PullWave, PublishedRows) {
  const PrintedTable table("pull_wave.csv");
  for (const auto& row : table.rows()) {
    const TwoHandPull p{1, 0.2, row.at("Y"), row.at("v_hand"), 0};
    const double t = 0.05 * 0.5 / row.at("v_hand");
    EXPECT_NEAR(hand_way_m(p, t) / 0.5, 0.05, 1e-12);
    table.expect(wave_speed_m_per_s(p), row.at("c"), row_text(row));
    table.expect(pull_strain(p, 0.5, 0), row.at("first_front"), row_text(row));
    EXPECT_EQ(reflections(p, t), row.at("reflections")) << row_text(row);
    table.expect(greatest_pull_strain(p, t), row.at("greatest_strain"), row_text(row));
    table.expect(t, row.at("time_s"), row_text(row));
    // The front's own formula has a place with that strain: the middle or an end, whichever it met last.
    EXPECT_NEAR(std::max(pull_strain(p, 0, t), pull_strain(p, 0.5, t)), greatest_pull_strain(p, t), 1e-9)
        << row_text(row);
  }
}

TEST(PullWave, PlateausOfTheDefaultScene) {
  TwoHandPull p;  // c = 70.71 m/s, 10 m/s
  p.ramp_s = pull_ramp_s(p);
  EXPECT_NEAR(p.ramp_s, 14.1e-3, 5e-5);
  const double crossing = 0.5 / wave_speed_m_per_s(p);
  EXPECT_NEAR(pull_strain(p, 0.5, p.ramp_s), 0.1414, 5e-5);
  EXPECT_NEAR(pull_strain(p, 0, p.ramp_s + crossing), 0.2828, 5e-5);
  EXPECT_NEAR(pull_strain(p, 0.5, 4 * crossing), 0.4243, 5e-5);
  EXPECT_EQ(pull_strain(p, 0, 0.999 * crossing), 0);
}

TEST(PullWave, SolvesTheWaveEquationWithItsEnds) {
  TwoHandPull p{0.8, 0.3, 120, 2, 0};
  const double half = 0.4, c2 = 400, k = 1e-6, h = 2e-5;
  for (const double ramp : {0.015, pull_ramp_s(p)}) {
    p.ramp_s = ramp;
    for (const double t : {0.013, 0.0471, 0.09, 0.2}) {
      for (const double x : {-0.31, 0.0, 0.22}) {
        const auto u = [&](double dx, double dt) { return pull_displacement_m(p, x + dx, t + dt); };
        const double tt = (u(0, k) - 2 * u(0, 0) + u(0, -k)) / (k * k),
                     xx = (u(h, 0) - 2 * u(0, 0) + u(-h, 0)) / (h * h);
        EXPECT_NEAR(tt, c2 * xx, 1e-1) << t << ' ' << x;
        EXPECT_NEAR(pull_speed_m_per_s(p, x, t), (u(0, k) - u(0, -k)) / (2 * k), 1e-7);
        EXPECT_NEAR(pull_strain(p, x, t), (u(h, 0) - u(-h, 0)) / (2 * h), 1e-7);
      }
      EXPECT_NEAR(pull_displacement_m(p, half, t), hand_way_m(p, t), 1e-14);
      EXPECT_NEAR(pull_displacement_m(p, -half, t), -hand_way_m(p, t), 1e-14);
      EXPECT_NEAR(pull_speed_m_per_s(p, half, t), speed_at(p, t), 1e-13);
      // The greatest is at least every sample, and the mean what the hands did.
      const double greatest = greatest_pull_strain(p, t);
      double mean = 0;
      for (int i = 0; i < 400; ++i) {
        const double strain = pull_strain(p, (i + 0.5) / 400 * half, t);
        mean += strain / 400;
        EXPECT_LE(strain, greatest * (1 + 1e-12));
      }
      EXPECT_NEAR(mean, hand_way_m(p, t) / half, 1e-4 * mean);
    }
  }
}

}  // namespace
}  // namespace clothbench::truth
