#include "runner/boundary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "clothbench/error.hpp"
#include "runner/stability_theory.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

TEST(Boundary, IsFoundToItsWidthAndAskedOnceForEachValue) {
  std::map<double, int> asked;
  const double turn = 37.7;
  const Boundary b = find_boundary({1, 10, 100, 1000}, 0.05, 0, [&](double x) {
    ++asked[x];
    return x <= turn;
  });
  EXPECT_LE(b.last_good, turn);
  EXPECT_GT(b.first_bad, turn);
  EXPECT_LE(std::log10(b.first_bad / b.last_good), 0.05);
  for (const auto& [x, times] : asked) EXPECT_EQ(times, 1) << x;
  EXPECT_EQ(asked.count(1000), 0u);  // stops at the first failure
}

TEST(Boundary, LooksBeyondItIfAsked) {
  int asked = 0;
  find_boundary({1, 2, 4, 8, 16}, 1, 2, [&](double x) {
    ++asked;
    return x < 2;
  });
  EXPECT_EQ(asked, 4);  // 1, 2 and two beyond
}

TEST(Boundary, SaysWhenThereIsNone) {
  const Boundary all = find_boundary({1, 10}, 0.05, 0, [](double) { return true; });
  EXPECT_EQ(all.last_good, 10);
  EXPECT_TRUE(std::isinf(all.first_bad));
  const Boundary none = find_boundary({1, 10}, 0.05, 0, [](double) { return false; });
  EXPECT_EQ(none.last_good, 0);
  EXPECT_EQ(none.first_bad, 1);
}

TEST(Expressions, AreProductsOfPowers) {
  EXPECT_DOUBLE_EQ(evaluate("x", 3, 5), 3);
  EXPECT_DOUBLE_EQ(evaluate("-x", 3, 5), -3);
  EXPECT_DOUBLE_EQ(evaluate("x^-1", 4, 5), 0.25);
  EXPECT_DOUBLE_EQ(evaluate("-0.5*x*y^2", 2, 3), -9);
  EXPECT_DOUBLE_EQ(evaluate("7", 2, 3), 7);
  for (const char* wrong : {"", "z", "x+1", "2**x", "x^", "x^y"}) EXPECT_THROW(evaluate(wrong, 1, 1), Error) << wrong;
}

Scene sheet(const char* material) {
  return scene_from_json(
      nlohmann::json::parse(
          std::string(
              R"({"name": "sheet", "why": "of the paper, in a test", "cloth": {"grid": [32, 32], "size_m": [1, 1],
    "areal_density_kg_per_m2": 0.2, "sides": "single"}, "material": )") +
          material + R"(, "time": {"frame_rate_hz": 60, "duration_s": 1}})"),
      "test");
}

TEST(Theory, HighestFrequencyOfTheSheetOf32) {
  // Computed with the springs' stiffness matrix: 4650 rad/s at Y = 1000 N/m, limit 0.430 ms.
  const Scene s = sheet(R"({"membrane_stiffness_N_per_m": 1000})");
  EXPECT_NEAR(highest_frequency_rad_per_s(s), 4650, 5);
  EXPECT_NEAR(theory("explicit-limit", s, 1), 0.430e-3, 1e-6);
  EXPECT_NEAR(theory("explicit-limit", s, 8), 8 * theory("explicit-limit", s, 1), 1e-12);
  EXPECT_TRUE(std::isinf(highest_frequency_rad_per_s(sheet(R"({"membrane_stiffness_N_per_m": "inextensible"})"))));
}

TEST(Theory, Float32FreezesAtATenthOfAKilometre) {
  // Between 512 and 1024 m an ulp is 6.1e-5 m and half of it is the displacement by gravity in 1.76 ms: 10 substeps of
  // 1/60 s are shorter.
  const Scene s = sheet(R"({"membrane_stiffness_N_per_m": 1000})");
  EXPECT_EQ(theory("float32-stagnation", s, 10), 512);
  EXPECT_EQ(theory("float32-stagnation", s, 8), 1024);
  EXPECT_EQ(theory("float32-stagnation", s, 32), 64);
}

}  // namespace
}  // namespace clothbench
