// Which stiffness an exact solution depends on, which decides whether a solver without it is ranked.
#include <gtest/gtest.h>

#include <cmath>

#include "metrics/truth_errors.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

/// Scenes are not listed by hand: which stiffness a truth depends on is found by changing it.
TEST(Dependence, IsMeasuredOnEveryTruth) {
  const auto needs = [](const std::string& name, const std::vector<std::string>& set = {}) {
    const auto found = truth_dependence(load_scene("validation/" + name, set));
    const auto at_least = [&](const char* key) { return found.contains(key) && found.at(key) >= 0.01; };
    return std::string(at_least("truth_dependence_Y") ? "Y" : "") + (at_least("truth_dependence_B") ? "B" : "");
  };
  EXPECT_EQ(needs("heavy-strip"), "Y");
  EXPECT_EQ(needs("two-hand-pull"), "Y");
  EXPECT_EQ(needs("cantilever-10"), "B");
  for (const char* name : {"free-fall", "pendulum", "swing-strip", "incline-stick"}) EXPECT_EQ(needs(name), "") << name;
  // The strip's stretch is rho g L^2 / 2 Y: a tenth more stiffness, an eleventh less stretch.
  const auto heavy = truth_dependence(load_scene("validation/heavy-strip"));
  EXPECT_NEAR(heavy.at("truth_dependence_Y"), (1 - 1 / 1.1) / std::log(1.1), 1e-6);
  EXPECT_EQ(needs("heavy-strip", {"material.membrane_stiffness_N_per_m=1e5"}), "Y") << "however little it stretches";
  EXPECT_TRUE(truth_dependence(load_scene("validation/hang")).empty()) << "no truth";
}

}  // namespace
}  // namespace clothbench
