#include "render/colours.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "clothbench/error.hpp"

namespace clothbench::render {
namespace {

double brightness(const Rgb& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

TEST(Colours, EndsAreTheStopsAndGreyStaysGrey) {
  const std::vector<Rgb> stops = {{0.1, 0.5, 0.9}, {0.7, 0.2, 0.3}};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(between(stops, 0)[k], stops[0][k], 1e-6);
    EXPECT_NEAR(between(stops, 1)[k], stops[1][k], 1e-6);
    EXPECT_NEAR(between(stops, 7)[k], stops[1][k], 1e-6);
  }
  const std::vector<Rgb> greys = {{0, 0, 0}, {1, 1, 1}};
  const Rgb middle = between(greys, 0.5);
  EXPECT_NEAR(middle[0], 0.466, 2e-3) << "L* = 50 is sRGB 119 of 255";
  EXPECT_NEAR(middle[0], middle[2], 1e-3);
}

TEST(Colours, MapsGetDarkerAwayFromNothing) {
  const std::vector<float> values = {-0.5f, 0.02f, 0.4f};
  const Scale strain = scale_for(Colour::Strain, values), depth = scale_for(Colour::Depth, values);
  for (int k = 1; k < 20; ++k) {
    const double a = k / 20.0, b = (k + 1) / 20.0;
    EXPECT_LT(brightness(strain.colour(b * strain.high)), brightness(strain.colour(a * strain.high)));
    EXPECT_LT(brightness(strain.colour(b * strain.low)), brightness(strain.colour(a * strain.low)));
    EXPECT_LT(brightness(depth.colour(b * depth.high)), brightness(depth.colour(a * depth.high)));
  }
}

TEST(Colours, ScalesAreRoundAndSayWhatTheyCut) {
  std::vector<float> values(1000, 0.0123f);
  values[0] = 3;
  values[1] = NAN;
  values[2] = INFINITY;
  const Scale s = scale_for(Colour::Strain, values);
  EXPECT_DOUBLE_EQ(s.high, 0.02);
  EXPECT_DOUBLE_EQ(s.low, -0.02);
  EXPECT_TRUE(s.clipped_high);
  EXPECT_FALSE(s.clipped_low);
  const Scale none = scale_for(Colour::Depth, std::vector<float>{0, 0, NAN});
  EXPECT_GT(none.high, 0);
  EXPECT_FALSE(none.clipped_high);
  EXPECT_FALSE(scale_for(Colour::Depth, std::vector<float>{0.002f}).clipped_high);
}

TEST(Colours, TablesAreWhatTheBarShows) {
  const Scale s = scale_for(Colour::Strain, std::vector<float>{0.1f});
  const std::vector<vec4> table = table_of(s);
  const std::vector<float> at = positions_on(s, std::vector<float>{-0.1f, 0, 0.1f, 5, NAN});
  EXPECT_NEAR(static_cast<double>(at[0]), 0, 1e-6);
  EXPECT_NEAR(static_cast<double>(at[1]), 0.5, 1e-6);
  EXPECT_NEAR(static_cast<double>(at[2]), 1, 1e-6);
  EXPECT_EQ(at[3], 1);
  EXPECT_TRUE(std::isnan(at[4]));
  EXPECT_NEAR(std::pow(static_cast<double>(table.front()[2]), 1 / 2.2), s.colour(s.low)[2], 0.02) << "linear";
}

TEST(Colours, AreKnownByName) {
  for (const Colour c : {Colour::Checker, Colour::Strain, Colour::Depth}) EXPECT_EQ(colour_from(name_of(c)), c);
  EXPECT_THROW(colour_from("red"), Error);
}

}  // namespace
}  // namespace clothbench::render
