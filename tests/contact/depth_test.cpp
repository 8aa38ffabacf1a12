#include <gtest/gtest.h>

#include <random>

#include "meshes.hpp"
#include "metrics/contact/tunnel.hpp"

namespace clothbench::contact {
namespace {

/// By solid angles (van Oosterom & Strackee 1983, eq. 8): another method than crossings of a ray.
double winding_number(const Point<3>& p, const TriangleTree& mesh) {
  double sum = 0;
  for (const Simplex<3>& v : mesh.triangles()) {
    const Point<3> a = v[0] - p, b = v[1] - p, c = v[2] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

TEST(Inside, AgreesWithSolidAngles) {
  const Mesh ball = bumpy_ball(10, 0.2);
  // A second one through the first: the winding number is 2 where both are.
  const Mesh both = together(ball, ball.moved({0.15, 0.02, 0.01}));
  const TriangleTree tree(both.view());
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-0.3, 0.4);
  int seen[3] = {};
  for (int i = 0; i < 2000; ++i) {
    const Point<3> p(unit(random), unit(random) - 0.05, unit(random) - 0.05);
    const double w = winding_number(p, tree);
    const int whole = static_cast<int>(std::lround(w));
    ASSERT_NEAR(w, whole, 1e-9);
    ASSERT_EQ(is_inside(p, tree), whole > 0);
    ++seen[whole];
  }
  EXPECT_GT(seen[0], 100);
  EXPECT_GT(seen[1], 100);
  EXPECT_GT(seen[2], 20);
}

TEST(Depth, IsDefinedOnlyWithAnInside) {
  const Mesh ball = octasphere(12, 0.1), cloth = sheet(32, 32, {-0.12, 0.085, -0.12}, {0, 0, 0.24}, {0.24, 0, 0});
  EXPECT_GT(against(cloth, ball).depth_max_m, 0);
  EXPECT_TRUE(std::isnan(against(cloth, ball, false).depth_max_m));
  EXPECT_EQ(against(cloth, ball, false).contour_length_m, against(cloth, ball).contour_length_m);
}

TEST(Distance, TreeFindsTheLeastOverAllTriangles) {
  const Mesh ball = bumpy_ball(9, 0.2);
  const TriangleTree tree(ball.view());
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-0.4, 0.4);
  for (int i = 0; i < 500; ++i) {
    const Point<3> p(unit(random), unit(random), unit(random));
    double least = INFINITY;
    for (const Simplex<3>& t : tree.triangles()) least = std::min(least, squared_distance(p, t));
    ASSERT_EQ(tree.distance(p), std::sqrt(least));
  }
}

TEST(Distance, ToATriangleAndToASliver) {
  const Simplex<3> v{Point<3>(0, 0, 0), Point<3>(4, 0, 0), Point<3>(0, 3, 0)};
  EXPECT_DOUBLE_EQ(squared_distance({1, 1, 2}, v), 4);
  EXPECT_DOUBLE_EQ(squared_distance({1, -2, 0}, v), 4);
  EXPECT_DOUBLE_EQ(squared_distance({-3, -4, 0}, v), 25);
  EXPECT_DOUBLE_EQ(squared_distance({7, -4, 0}, v), 25);
  EXPECT_DOUBLE_EQ(squared_distance({2 + 3, 1.5 + 4, 0}, v), 25);
  const Simplex<3> sliver{Point<3>(0, 0, 0), Point<3>(4, 0, 0), Point<3>(2, 0x1p-1000, 0)};
  EXPECT_DOUBLE_EQ(squared_distance({1, 0, 2}, sliver), 4);
  EXPECT_DOUBLE_EQ(squared_distance({7, 4, 0}, sliver), 25);
}

}  // namespace
}  // namespace clothbench::contact
