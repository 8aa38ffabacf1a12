#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "clothbench/error.hpp"
#include "elastic_catenary.hpp"
#include "frequencies.hpp"
#include "impact.hpp"
#include "lateral_buckling.hpp"
#include "self_buckling.hpp"
#include "spin.hpp"
#include "sudden_gravity.hpp"
#include "truth/atwood.hpp"
#include "truth/capstan.hpp"
#include "truth/catenary.hpp"
#include "truth/discrete_elastica.hpp"
#include "truth/elastica.hpp"
#include "truth/free_fall.hpp"
#include "truth/heavy_stretch.hpp"
#include "truth/incline.hpp"
#include "truth/pendulum.hpp"
#include "truth/pull_wave.hpp"
#include "truth/swinging_chain.hpp"

namespace clothbench::truth {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

struct BadCall {
  const char* argument;  ///< the message names it
  std::function<void()> call;
};

class BadArgument : public testing::TestWithParam<BadCall> {};

TEST_P(BadArgument, IsNamed) {
  try {
    GetParam().call();
    FAIL() << "accepted a bad " << GetParam().argument;
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(GetParam().argument), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("expected"), std::string::npos) << e.what();
  }
}

const std::vector<double> kBackwards{0.2, 0.1}, kOne{0.1};

INSTANTIATE_TEST_SUITE_P(Motion, BadArgument,
                         testing::Values(BadCall{"time_s", [] { fall_height_m({}, -1); }},
                                         BadCall{"time_s", [] { fall_height_m({}, kNan); }},
                                         BadCall{"gravity",
                                                 [] {
                                                   fall_speed_m_per_s({0, 0, -1, 0}, 1);
                                                 }},
                                         BadCall{"damping",
                                                 [] {
                                                   fall_height_m({0, 0, 1, kInfinity}, 1);
                                                 }},
                                         BadCall{"angular_speed",
                                                 [] {
                                                   spin_radius_m({0.5, 0.2, 1000, 223}, 0.5);
                                                 }},
                                         BadCall{"rest_radius_m", [] { spin_strain({}, 0.6); }},
                                         BadCall{"amplitude_rad",
                                                 [] {
                                                   pendulum_period_s({1, 9.81, 3.2});
                                                 }},
                                         BadCall{"amplitude_rad",
                                                 [] {
                                                   pendulum_angle_rad({1, 9.81, 0}, 1);
                                                 }},
                                         BadCall{"links", [] { swing({0}, kOne); }},
                                         BadCall{"times_s", [] { swing({}, kBackwards); }},
                                         BadCall{"end_mass_ratio",
                                                 [] {
                                                   swing({4, 1, 9.81, 0}, kOne);
                                                 }},
                                         BadCall{"tolerance", [] { swing({}, kOne, kNan); }},
                                         BadCall{"share", [] { chain_position_m(swing({}, kOne)[0], 1.1); }},
                                         BadCall{"angle_rad",
                                                 [] {
                                                   sticks({2, 0.3, 0, 9.81});
                                                 }},
                                         BadCall{"friction",
                                                 [] {
                                                   stop({0.1, -0.3, 0, 9.81});
                                                 }},
                                         BadCall{"speed_m_per_s",
                                                 [] {
                                                   slide_distance_m({0.1, 0.3, -1, 9.81}, 1);
                                                 }},
                                         BadCall{"offset_m",
                                                 [] {
                                                   atwood_end_s({1, 0.05, 0.43});
                                                 }},
                                         BadCall{"time_s", [] { atwood_offset_m({}, 5); }},
                                         BadCall{"restitution",
                                                 [] {
                                                   contact_time_s({1, 1.1});
                                                 }},
                                         BadCall{"bounce", [] { rebound_height_m({}, 0); }}));

INSTANTIATE_TEST_SUITE_P(Stretch, BadArgument,
                         testing::Values(BadCall{"rest_m", [] { hang_displacement_m({}, 1.1); }},
                                         BadCall{"end_load",
                                                 [] {
                                                   hang_displacement_m({1, 1, 1, 1, -1}, 0);
                                                 }},
                                         BadCall{"membrane_stiffness",
                                                 [] {
                                                   hang_displacement_m({1, 1, 0}, 0);
                                                 }},
                                         BadCall{"row", [] { hang_row_displacement_m({}, 4, 5); }},
                                         BadCall{"rest_m", [] { sudden_gravity_displacement_m({}, -0.1, 1); }},
                                         BadCall{"time_s", [] { sudden_gravity_strain({}, 0.1, kNan); }},
                                         BadCall{"rest_x_m", [] { pull_displacement_m({}, 0.6, 1); }},
                                         BadCall{"ramp_s", [] {
                                                   hand_way_m({1, 1, 1, 1, -1}, 1);
                                                 }}));

INSTANTIATE_TEST_SUITE_P(Shapes, BadArgument,
                         testing::Values(BadCall{"span_m", [] { Catenary(1, 1); }},
                                         BadCall{"span_m", [] { Catenary(1, kNan); }},
                                         BadCall{"rest_m", [] { Catenary(1, 0.5).position_m(2); }},
                                         BadCall{"links", [] { DiscreteCatenary(1, 1, 0.5); }},
                                         BadCall{"span_m", [] { ElasticCatenary(1, 4, 1, 1, 1); }},
                                         BadCall{"areal_density", [] { ElasticCatenary(1, 0.5, 0, 1, 1); }},
                                         BadCall{"own_weight",
                                                 [] {
                                                   Elastica({-1, 0, 0});
                                                 }},
                                         BadCall{"own_weight",
                                                 [] {
                                                   Elastica({kNan, 0, 0});
                                                 }},
                                         BadCall{"tip_load",
                                                 [] {
                                                   Elastica({0, 2e4, 0});
                                                 }},
                                         BadCall{"clamp_angle",
                                                 [] {
                                                   Elastica({1, 0, 2});
                                                 }},
                                         BadCall{"argument s",
                                                 [] {
                                                   Elastica({1, 0, 0}).angle_rad(1.5);
                                                 }},
                                         BadCall{"links",
                                                 [] {
                                                   DiscreteElastica({0, 1});
                                                 }},
                                         BadCall{"own_weight",
                                                 [] {
                                                   DiscreteElastica({8, kInfinity});
                                                 }},
                                         BadCall{"links", [] { discrete_self_buckling_own_weight(0); }},
                                         BadCall{"poisson_ratio", [] { lateral_buckling(0.5, 0.6); }},
                                         BadCall{"width_over_length", [] { lateral_buckling(2.1, 0.3); }},
                                         BadCall{"width_over_length", [] { lateral_buckling(1.5, 0.4); }},
                                         BadCall{"poisson_ratio", [] { narrow_lateral_buckling(kNan); }}));

INSTANTIATE_TEST_SUITE_P(Others, BadArgument,
                         testing::Values(BadCall{"mode", [] { hanging_strip_frequency(0, 1, 1); }},
                                         BadCall{"mode", [] { hanging_chain_frequency(5, 4, 1, 1); }},
                                         BadCall{"mode", [] { taut_chain_frequency(4, 4, 1, 1, 1); }},
                                         BadCall{"tension", [] { taut_string_frequency(1, 1, -1, 1); }},
                                         BadCall{"side_a_m", [] { membrane_sag_m(0, 1, 1, 1, 1); }},
                                         BadCall{"mode", [] { cantilever_root(0); }},
                                         BadCall{"step_s", [] { implicit_euler_damping(1, 0); }},
                                         BadCall{"friction", [] { capstan_ratio(kNan, 1); }},
                                         BadCall{"friction", [] { polygonal_greatest_overhang_m({2}, 1, 2); }},
                                         BadCall{"turns", [] { polygonal_greatest_overhang_m({}, 1, 0); }},
                                         BadCall{"light_overhang", [] { greatest_overhang_m({}, -1); }},
                                         BadCall{"phi_rad", [] { slip_tension_N_per_m({}, 1, 4); }},
                                         BadCall{"radius_m", [] {
                                                   greatest_overhang_m({0.3, -1}, 1);
                                                 }}));

}  // namespace
}  // namespace clothbench::truth
