// Wrong motions fail by what positions say, and right ones pass: no bound of a scene is asked.
#include <gtest/gtest.h>

#include <cstdio>

#include "base/interval.hpp"
#include "trial.hpp"

namespace clothbench::liars {
namespace {

/// 97 % of the lies that positions determine, within the interval of so many trials; each right motion, with noise of
/// half of a tolerance too.
void expect_told_apart(const Matrix& matrix, std::size_t fewest) {
  const std::vector<Trial> trials = tell_all(matrix);
  const Totals n = totals(trials);
#ifdef CLOTHBENCH_MANY_LIES
  std::puts(as_text(trials).c_str());  // the rate with its interval
#endif
  EXPECT_GE(n.told, fewest);
  EXPECT_GE(wilson_95(n.caught, n.told).high, 0.97) << as_text(trials);
  EXPECT_GE(static_cast<double>(n.passed), 0.995 * static_cast<double>(n.right)) << as_text(trials);
  EXPECT_GE(static_cast<double>(n.noisy_passed), 0.995 * static_cast<double>(n.noisy)) << as_text(trials);
}

#ifndef CLOTHBENCH_MANY_LIES
TEST(Liars, OfContact) {
  Matrix matrix;
  matrix.solver = "bullet-deformable";
  matrix.kinds = {"incline-slip", "plate"};
  matrix.motions = 2;
  expect_told_apart(matrix, 60);
}
#else
TEST(Liars, OfAThousandAreSeen) {
  Matrix matrix;
  matrix.seed = 5000;
  matrix.motions = 80;
  expect_told_apart(matrix, 1000);
}
#endif

}  // namespace
}  // namespace clothbench::liars
