#include <gtest/gtest.h>

#include <cmath>

#include "base/dice.hpp"
#include "base/interval.hpp"
#include "clothbench/error.hpp"

namespace clothbench {
namespace {

TEST(Wilson, AgreesWithPublishedIntervals) {
  // R. G. Newcombe, Statistics in Medicine 17 (1998) 857, table I, method 3.
  const struct {
    std::size_t passed, drawn;
    double low, high;
  } published[] = {{81, 263, 0.2553, 0.3662}, {15, 148, 0.0624, 0.1605}, {0, 20, 0, 0.1611}, {1, 29, 0.0061, 0.1718}};
  for (const auto& p : published) {
    const Interval i = wilson_95(p.passed, p.drawn), other = wilson_95(p.drawn - p.passed, p.drawn);
    EXPECT_NEAR(i.low, p.low, 5e-5);
    EXPECT_NEAR(i.high, p.high, 5e-5);
    EXPECT_NEAR(other.low, 1 - i.high, 1e-15);
    EXPECT_NEAR(other.high, 1 - i.low, 1e-15);
  }
  EXPECT_EQ(wilson_95(0, 20).low, 0);
  EXPECT_EQ(wilson_95(20, 20).high, 1);
  EXPECT_EQ(wilson_95(0, 0).low, 0);
  EXPECT_EQ(wilson_95(0, 0).high, 1);
  EXPECT_THROW(wilson_95(3, 2), Error);
}

TEST(Dice, ThrowTheSameForASeedAndAWord) {
  Dice a(7, "word"), b(7, "word"), other_seed(8, "word"), other_word(7, "words");
  const double first = a.unit();
  EXPECT_EQ(first, b.unit());
  EXPECT_NE(first, other_seed.unit());
  EXPECT_NE(first, other_word.unit());
  for (int k = 0; k < 1000; ++k) {
    EXPECT_TRUE(a.between(-2, 3) >= -2 && b.between(-2, 3) < 3);
    EXPECT_TRUE(a.log_between(0.1, 15) >= 0.1 && b.log_between(0.1, 15) < 15);
    const int whole = a.whole(2, 4);
    EXPECT_TRUE(whole >= 2 && whole <= 4);
    const auto r = a.rotation();
    EXPECT_NEAR(r[0][0] * r[1][0] + r[0][1] * r[1][1] + r[0][2] * r[1][2], 0, 1e-12);
    EXPECT_NEAR(std::hypot(r[2][0], r[2][1], r[2][2]), 1, 1e-12);
  }
}

}  // namespace
}  // namespace clothbench
