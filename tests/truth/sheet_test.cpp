// Sheets of springs that shear.
#include <gtest/gtest.h>

#include <cmath>

#include "clothbench/error.hpp"
#include "truth/spring_sheet.hpp"

namespace clothbench::truth {
namespace {

const HeldPosition kNothing = [](std::size_t, std::size_t) { return std::array<double, 3>{}; };

/// Corners of a square that move along its diagonals: edges keep their directions, so that the springs are linear at
/// any amplitude. Energy 4 (k_edge + k_diagonal) d^2 against 2 m d'^2 gives w^2 = 6 Y/(rho a^2).
TEST(SpringSheet, SquareBreathesAtItsFrequency) {
  const double a = 0.3, Y = 70, rho = 0.4, d0 = 0.02, w = std::sqrt(6 * Y / rho) / a;
  std::vector<double> start;
  for (const double v : {-1.0, 1.0})
    for (const double u : {-1.0, 1.0})
      for (const double x : {u * (a / 2 + d0 / std::sqrt(2)), v * (a / 2 + d0 / std::sqrt(2)), 0.0}) start.push_back(x);
  const std::vector<double> times = {0, 0.013, 0.1};
  const auto states = move_sheet({2, 2, a, a, rho, Y, {0, 0, -9.81}, {}}, start, times, kNothing);
  for (std::size_t f = 0; f < times.size(); ++f) {
    const double d = d0 * std::cos(w * times[f]), t = times[f];
    EXPECT_NEAR(states[f][9], a / 2 + d / std::sqrt(2), 1e-9) << t;
    EXPECT_NEAR(states[f][10], a / 2 + d / std::sqrt(2), 1e-9) << t;
    EXPECT_NEAR(states[f][11], -0.5 * 9.81 * t * t, 1e-9) << t;
  }
}

/// An even strain of Poisson ratio 1/3 under tension along u: no inner vertex and no free edge is pushed. Cells that
/// are not square have the same moduli.
TEST(SpringSheet, HasThePoissonRatioOfAThird) {
  const int columns = 6, rows = 4;
  const double width = 0.5, height = 0.24, strain = 1e-7;
  SpringSheet sheet{columns, rows, width, height, 0.2, 1000, {}, {}};
  std::vector<double> start;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      for (const double x : {width * i / (columns - 1) * (1 + strain), height * j / (rows - 1) * (1 - strain / 3), 0.0})
        start.push_back(x);
      if (i == 0 || i + 1 == columns) sheet.held.push_back(static_cast<std::uint32_t>(j * columns + i));
    }
  const HeldPosition stay = [&](std::size_t k, std::size_t) {
    const std::size_t v = 3 * std::size_t{sheet.held[k]};
    return std::array<double, 3>{start[v], start[v + 1], start[v + 2]};
  };
  const auto end = move_sheet(sheet, start, std::vector<double>{0, 0.01}, stay).back();
  for (std::size_t k = 0; k < end.size(); ++k) EXPECT_NEAR(end[k], start[k], 1e-5 * strain) << k;
}

TEST(SpringSheet, RefusesBadArguments) {
  const SpringSheet sheet{2, 2, 1, 1, 0.2, 1000, {}, {}};
  const std::vector<double> start = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, times = {0, 0.1};
  EXPECT_NO_THROW(move_sheet(sheet, start, times, kNothing));
  SpringSheet bad = sheet;
  bad.membrane_stiffness_N_per_m = std::nan("");
  EXPECT_THROW(move_sheet(bad, start, times, kNothing), Error);
  bad = sheet;
  bad.held = {4};
  EXPECT_THROW(move_sheet(bad, start, times, kNothing), Error);
  EXPECT_THROW(move_sheet(sheet, {start.data(), 9}, times, kNothing), Error);
  EXPECT_THROW(move_sheet(sheet, start, std::vector<double>{0, -1}, kNothing), Error);
}

}  // namespace
}  // namespace clothbench::truth
