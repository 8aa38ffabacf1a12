#include <array>
#include <numbers>

#include "impact.hpp"
#include "integrated.hpp"
#include "printed_table.hpp"
#include "spin.hpp"
#include "truth/atwood.hpp"
#include "truth/free_fall.hpp"
#include "truth/incline.hpp"
#include "truth/pendulum.hpp"

namespace clothbench::truth {
namespace {

using Pair = std::array<double, 2>;
using State = std::vector<double>;

TEST(FreeFall, Undamped) {
  const FreeFall f{2, 3, 9.81, 0};
  EXPECT_DOUBLE_EQ(fall_height_m(f, 0.5), 2 + 1.5 - 9.81 / 8);
  EXPECT_DOUBLE_EQ(fall_speed_m_per_s(f, 0.5), 3 - 9.81 / 2);
}

TEST(FreeFall, DampedSolvesItsEquation) {
  for (const double c : {1e-9, 1e-3, 0.1, 1.0, 1.999999, 2.000001, 30.0}) {
    const FreeFall f{2, 3, 9.81, c};
    const auto y = integrated({2, 3}, 0.5, [&](const State& s, State& d, double) { d = {s[1], -9.81 - c * s[1]}; });
    EXPECT_NEAR(fall_height_m(f, 0.5), y[0], 1e-12) << c;
    EXPECT_NEAR(fall_speed_m_per_s(f, 0.5), y[1], 1e-12) << c;
  }
  // Terminal speed.
  EXPECT_NEAR(fall_speed_m_per_s({0, 0, 9.81, 4}, 100), -9.81 / 4, 1e-12);
}

TEST(Spin, PublishedTipRadii) {
  // tan(k l)/k, l = 0.5 m, Y = 1000 N/m, rho = 0.2 kg/m2.
  const Pair printed[] = {{5, 0.50020844}, {10, 0.50083500}, {20, 0.50336022}, {40, 0.51377428}};
  for (const auto& [speed, tip] : printed) EXPECT_NEAR(spin_radius_m({0.5, 0.2, 1000, speed}, 0.5), tip, 5e-9);
}

TEST(Spin, SolvesItsEquationAndStiffensToRigid) {
  const SpinningStrip s{0.3, 0.7, 150, 22};
  const double h = 1e-4, x = 0.17;
  const double second = (spin_radius_m(s, x + h) - 2 * spin_radius_m(s, x) + spin_radius_m(s, x - h)) / (h * h);
  EXPECT_NEAR(second, -0.7 * 22 * 22 / 150 * spin_radius_m(s, x), 1e-6);
  EXPECT_NEAR(spin_strain(s, x), (spin_radius_m(s, x + h) - spin_radius_m(s, x - h)) / (2 * h) - 1, 1e-7);
  EXPECT_EQ(spin_strain(s, 0.3), 0);
  EXPECT_NEAR(spin_radius_m({0.3, 0.7, 1e12, 22}, 0.3), 0.3, 1e-10);
  const auto p = rotated({1, 2}, std::numbers::pi, 0.5);
  EXPECT_NEAR(p[0], -2, 1e-15);
  EXPECT_NEAR(p[1], 1, 1e-15);
}

TEST(Pendulum, PublishedPeriods) {
  const PrintedTable table("pendulum.csv");
  for (const auto& row : table.rows()) {
    const Pendulum p{1, 9.81, row.at("amplitude_deg") * kDegree};
    table.expect(pendulum_period_s(p) / (2 * std::numbers::pi * std::sqrt(1 / 9.81)), row.at("period_over_small"),
                 row_text(row));
    table.expect(pendulum_period_s(p), row.at("period_1m_s"), row_text(row));
  }
}

TEST(Pendulum, PublishedAngles) {
  const Pendulum p{1, 9.81, std::numbers::pi / 2};
  const Pair printed[] = {{0.1, 1.5217503}, {0.2, 1.3748476}, {0.3, 1.1321863}, {0.4, 0.8016301}, {0.5, 0.4017708}};
  for (const auto& [t, angle] : printed) EXPECT_NEAR(pendulum_angle_rad(p, t), angle, 5e-8) << t;
}

TEST(Pendulum, SolvesItsEquation) {
  for (const double degrees : {1.0, 60.0, 135.0, 179.0}) {
    const Pendulum p{0.4, 3.7, degrees * kDegree};
    for (const double periods : {0.13, 0.5, 0.77, 1.9}) {
      const double t = periods * pendulum_period_s(p);
      const auto y = integrated({p.amplitude_rad, 0}, t, [](const State& s, State& d, double) {
        d = {s[1], -3.7 / 0.4 * std::sin(s[0])};
      });
      EXPECT_NEAR(pendulum_angle_rad(p, t), y[0], 1e-8) << degrees << ' ' << periods;
      EXPECT_NEAR(pendulum_angular_speed_rad_per_s(p, t), y[1], 1e-7) << degrees << ' ' << periods;
    }
  }
}

TEST(Incline, PublishedRows) {
  const PrintedTable table("incline.csv");
  for (const auto& row : table.rows()) {
    const Incline i{row.at("angle_deg") * kDegree, row.at("friction"), 1, 9.81};
    EXPECT_EQ(sticks(i), row.at("slides") == 0) << row_text(row);
    table.expect(sticks(i) ? 0 : sliding_acceleration_m_per_s2(i), row.at("acceleration"), row_text(row));
    table.expect(stop(i).distance_m, row.at("stop_distance"), row_text(row));
    table.expect(stop(i).time_s, row.at("stop_time"), row_text(row));
  }
  EXPECT_TRUE(sticks({16.6991 * kDegree, 0.3, 0, 9.81}));
  EXPECT_FALSE(sticks({16.6993 * kDegree, 0.3, 0, 9.81}));
}

TEST(Incline, MotionIsThatOfTheStop) {
  const Incline slowing{10 * kDegree, 0.5, 2, 9.81}, slipping{30 * kDegree, 0.3, 0, 9.81},
      resting{10 * kDegree, 0.5, 0, 9.81};
  const Stop s = stop(slowing);
  EXPECT_NEAR(slide_distance_m(slowing, s.time_s * (1 - 1e-9)), s.distance_m, 1e-12);
  EXPECT_EQ(slide_distance_m(slowing, 10 * s.time_s), s.distance_m);
  EXPECT_EQ(slide_speed_m_per_s(slowing, 10 * s.time_s), 0);
  EXPECT_NEAR(slide_speed_m_per_s(slowing, s.time_s / 2), 1, 1e-12);
  EXPECT_NEAR(slide_distance_m(slipping, 2), 2 * 2.356287, 2e-6);
  EXPECT_EQ(slide_distance_m(resting, 2), 0);
  EXPECT_EQ(stop(resting).distance_m, 0);
  EXPECT_FALSE(stop(slipping).stops);
  const Pair flat[] = {{0.1, 0.509684}, {0.3, 0.169895}, {0.5, 0.101937}};
  for (const auto& [mu, distance] : flat) EXPECT_NEAR(stop({0, mu, 1, 9.81}).distance_m, distance, 5e-7);
}

TEST(Atwood, PublishedOffsets) {
  EXPECT_NEAR(atwood_offset_m({}, 0.2), 0.0709372, 5e-8);
  EXPECT_NEAR(atwood_offset_m({}, 0.3), 0.101036, 5e-7);
  EXPECT_NEAR(atwood_offset_m({}, 0.4), 0.151283, 5e-7);
}

TEST(Atwood, SolvesItsEquationWhileItKeepsToTheCylinder) {
  const Atwood a{0.7, 0.03, 0.01, 4};
  const double end = atwood_end_s(a), t = 0.8 * end;
  const auto y = integrated({0.01, 0}, t, [](const State& s, State& d, double) { d = {s[1], 2 * 4 / 0.7 * s[0]}; });
  EXPECT_NEAR(atwood_offset_m(a, t), y[0], 1e-12);
  EXPECT_NEAR(atwood_speed_m_per_s(a, t), y[1], 1e-12);
  // At the end the light side's element pulls itself off: tension (per mass per length) equals speed squared.
  const double s = atwood_offset_m(a, end), v = atwood_speed_m_per_s(a, end);
  const double overhang = 0.5 * (0.7 - std::numbers::pi * 0.03) - s;
  EXPECT_GT(overhang, 0);
  EXPECT_NEAR(overhang * (4 + 2 * 4 / 0.7 * s), v * v, 1e-12);
  EXPECT_GT(atwood_end_s({}), 0.4);
}

TEST(Impact, PublishedContact) {
  const Drop d{0.3, 0, 9.81};
  EXPECT_NEAR(contact_time_s(d), 0.247310, 5e-7);
  EXPECT_NEAR(contact_speed_m_per_s(d), 2.42611, 5e-6);
  EXPECT_EQ(height_above_plane_m(d, 0.25), 0);
  EXPECT_EQ(rest_time_s(d), contact_time_s(d));
}

TEST(Impact, Bounces) {
  const Drop d{0.3, 0.6, 9.81};
  const double fall = contact_time_s(d);
  EXPECT_NEAR(rebound_height_m(d, 3), 0.3 * std::pow(0.6, 6), 1e-16);
  for (int bounce = 1; bounce < 6; ++bounce) {
    double top = fall;
    for (int k = 1; k < bounce; ++k) top += 2 * fall * std::pow(0.6, k);
    EXPECT_NEAR(height_above_plane_m(d, top), 0, 1e-14);
    top += fall * std::pow(0.6, bounce);
    EXPECT_NEAR(height_above_plane_m(d, top), rebound_height_m(d, bounce), 1e-14);
  }
  EXPECT_NEAR(rest_time_s(d), fall * 4, 1e-14);
  EXPECT_EQ(height_above_plane_m(d, 5 * fall), 0);
  EXPECT_NEAR(height_above_plane_m({0.3, 1, 9.81}, 10 * fall), 0.3, 1e-12);
  EXPECT_TRUE(std::isinf(rest_time_s({0.3, 1, 9.81})));
}

}  // namespace
}  // namespace clothbench::truth
