#include "render/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "clothbench/error.hpp"
#include "sheets.hpp"

namespace clothbench::render {
namespace {

/// Clip coordinates of a point, as the vertex shader computes them.
std::array<double, 4> clip(const Camera& c, const Vec3& origin, const Vec3& p) {
  const Mat4 m = c.projection() * c.view(origin);
  std::array<double, 4> out{};
  for (std::size_t r = 0; r < 4; ++r)
    out[r] = m[r] * (p[0] - origin[0]) + m[4 + r] * (p[1] - origin[1]) + m[8 + r] * (p[2] - origin[2]) + m[12 + r];
  return out;
}

std::vector<double> cloud(unsigned seed, const Vec3& middle) {
  std::mt19937 random(seed);
  std::normal_distribution<double> x(0, 1);
  std::vector<double> out;
  for (int k = 0; k < 50; ++k)
    for (std::size_t a = 0; a < 3; ++a) out.push_back(middle[a] + x(random) * (a == 1 ? 0.3 : 1));
  return out;
}

TEST(Camera, SeesEverythingAndFillsThePictureOneWay) {
  for (unsigned seed = 0; seed < 20; ++seed)
    for (const double aspect : {0.5, 1.0, 16.0 / 9}) {
      const Vec3 middle = {100.0 * seed, 5, -3};
      const std::vector<double> points = cloud(seed, middle);
      const Camera c = frame(points, aspect);
      double low[2] = {1, 1}, high[2] = {0, 0};
      for (std::size_t k = 0; k < points.size(); k += 3) {
        const Vec3 p = {points[k], points[k + 1], points[k + 2]};
        const auto at = seen_at(c, p);
        ASSERT_TRUE(at.has_value());
        const auto q = clip(c, middle, p);
        EXPECT_GE(q[2], 0);
        EXPECT_LE(q[2], q[3]);
        for (std::size_t a = 0; a < 2; ++a) {
          EXPECT_NEAR(0.5 + 0.5 * q[a] / q[3], (*at)[a], 1e-9) << "the matrices agree with the tangents";
          low[a] = std::min(low[a], (*at)[a]);
          high[a] = std::max(high[a], (*at)[a]);
        }
      }
      for (std::size_t a = 0; a < 2; ++a) {
        EXPECT_GE(low[a], 0.04 - 1e-9);
        EXPECT_LE(high[a], 0.96 + 1e-9);
      }
      EXPECT_NEAR(std::max(high[0] - low[0], high[1] - low[1]), 0.92, 1e-6) << "no nearer camera sees all";
    }
}

TEST(Camera, LooksFromTheRightAndAbove) {
  const std::vector<double> square = {-1, 0, -1, 1, 0, -1, -1, 0, 1, 1, 0, 1, 0, 1, 0};
  const Camera c = frame(square, 1);
  EXPECT_GT((*seen_at(c, {1, 0, 0}))[0], (*seen_at(c, {0, 0, 0}))[0]) << "+x to the right";
  EXPECT_LT((*seen_at(c, {0, 1, 0}))[1], (*seen_at(c, {0, 0, 0}))[1]) << "+y up";
  EXPECT_TRUE(c.eye_m[0] > 0 && c.eye_m[1] > 0 && c.eye_m[2] > 0);
}

TEST(Camera, FramesAPointAndASheetSeenEdgeOn) {
  const std::vector<double> point = {1, 2, 3}, edge_on = {-1, 0, 0, 1, 0, 0, 0, 0, 0};
  for (const auto& points : {point, edge_on}) {
    const Camera c = frame(points, 1.5);
    for (const double x : c.projection()) EXPECT_TRUE(std::isfinite(x));
    for (std::size_t k = 0; k < points.size(); k += 3)
      EXPECT_TRUE(seen_at(c, {points[k], points[k + 1], points[k + 2]}).has_value());
  }
  EXPECT_THROW(frame({}, 1), Error);
}

TEST(Camera, EyesAreApartAndParallel) {
  const auto [left, right] = eyes({1, 2, 3}, 2, 0.1, 100);
  EXPECT_NEAR(right.eye_m[0] - left.eye_m[0], 0.063, 1e-12);
  EXPECT_EQ(left.back, right.back);
  EXPECT_NEAR(0.5 * ((*seen_at(left, {1, 2, 3}))[0] + (*seen_at(right, {1, 2, 3}))[0]), 0.5, 1e-12);
}

}  // namespace
}  // namespace clothbench::render
