#include <gtest/gtest.h>

#include <random>

#include "meshes.hpp"
#include "metrics/contact/contact_probe.hpp"
#include "metrics/contact/winding.hpp"

namespace clothbench::contact {
namespace {

constexpr double kPi = std::numbers::pi;

// Above the middle of an open rectangle with half sides a, b: atan(ab / (z sqrt(a^2 + b^2 + z^2))) / pi. Only the
// change by 1 across it is a matter of sides.
TEST(Winding, OpenPatch) {
  const TriangleTree tree(patch(4).view());
  const double a = 0.5;
  for (const double z : {0.01, 0.1, 1.0}) {
    const double exact = std::atan(a * a / (z * std::sqrt(2 * a * a + z * z))) / kPi;
    EXPECT_NEAR(winding_number({0, z, 0}, tree), -exact, 1e-12);
    EXPECT_NEAR(winding_number({0, -z, 0}, tree), exact, 1e-12);
  }
  EXPECT_NEAR(winding_number({0, -0.01, 0}, tree), 0.491, 5e-4);
  EXPECT_NEAR(winding_number({0, -0.1, 0}, tree), 0.411, 5e-4);
  EXPECT_NEAR(winding_number({0, -1, 0}, tree), 0.064, 5e-4);
}

TEST(Winding, ClosedMeshesAgreeWithTheFullSum) {
  const Mesh ball = bumpy_ball(10, 0.2);
  // A second one through the first: the winding number is 2 where both are.
  Mesh both = ball;
  const Mesh other = ball.moved({0.15, 0.02, 0.01});
  both.positions.insert(both.positions.end(), other.positions.begin(), other.positions.end());
  const auto shift = static_cast<std::uint32_t>(ball.positions.size() / 3);
  for (const auto& t : other.triangles) both.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  const TriangleTree tree(both.view());
  ASSERT_TRUE(is_closed(both.view(), welded_vertices(both.view())));
  const InsideTest closed(tree, true), clustered(tree, false);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-0.3, 0.4);
  int seen[3] = {};
  for (int i = 0; i < 2000; ++i) {
    const Point<3> p(unit(random), unit(random) - 0.05, unit(random) - 0.05);
    const double w = winding_number(p, tree);
    const int whole = static_cast<int>(std::lround(w));
    ASSERT_NEAR(w, whole, 1e-9);
    ASSERT_EQ(closed.estimate(p), whole);
    ASSERT_NEAR(clustered.estimate(p), w, 0.05);
    ASSERT_EQ(clustered(p), closed(p));
    ++seen[whole];
  }
  EXPECT_GT(seen[0], 100);
  EXPECT_GT(seen[1], 100);
  EXPECT_GT(seen[2], 20);
}

/// Without the triangles whose first two vertices lie below `level`.
Mesh cut_below(const Mesh& whole, double level) {
  Mesh open = whole;
  std::erase_if(open.triangles, [&](const auto& t) {
    return whole.view().vertex(t[0])[1] < level && whole.view().vertex(t[1])[1] < level;
  });
  return open;
}

// In the mouth of a bowl the winding number passes through 1/2, and the far-field sum errs about which side of it.
TEST(Winding, DoubtfulEstimatesAreSummedInFull) {
  const Mesh bowl = cut_below(octasphere(24, 0.1), -0.03);
  const TriangleTree tree(bowl.view());
  const InsideTest inside(tree, false);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> across(-0.06, 0.06), height(-0.06, 0.0);
  int misled = 0;
  for (int i = 0; i < 3000; ++i) {
    const Point<3> p(across(random), height(random), across(random));
    const bool exact = winding_number(p, tree) > 0.5;
    ASSERT_EQ(inside(p), exact);
    misled += (inside.estimate(p) > 0.5) != exact;
  }
  EXPECT_GT(misled, 0);
}

TEST(Winding, BallWithAHoleStillHasAnInside) {
  const Mesh whole = octasphere(12, 0.1), open = cut_below(whole, -0.09);
  ASSERT_LT(open.triangles.size(), whole.triangles.size());
  EXPECT_TRUE(is_closed(whole.view(), welded_vertices(whole.view())));
  EXPECT_FALSE(is_closed(open.view(), welded_vertices(open.view())));
  const Mesh cloth = sheet(32, 32, {-0.12, 0.085, -0.12}, {0, 0, 0.24}, {0.24, 0, 0});
  const auto sample = [&](const Mesh& object, Solid solid) {
    return ContactProbe(cloth.view(), object.view(), solid).probe(cloth.positions);
  };
  const ContactSample nearly = sample(open, Solid::Nearly), closed = sample(whole, Solid::Auto);
  EXPECT_NEAR(nearly.depth_max_m, closed.depth_max_m, 1e-12);
  EXPECT_GT(closed.depth_max_m, 0);
  EXPECT_TRUE(std::isnan(sample(open, Solid::Auto).depth_max_m));
  EXPECT_TRUE(std::isnan(sample(whole, Solid::No).depth_max_m));
  EXPECT_EQ(sample(whole, Solid::No).contour_length_m, closed.contour_length_m);
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

TEST(Distance, Capsule) {
  const Capsule c{{0, 0, 0}, {2, 0, 0}, 0.5};
  EXPECT_DOUBLE_EQ(signed_distance({1, 2, 0}, c), 1.5);
  EXPECT_DOUBLE_EQ(signed_distance({5, 4, 0}, c), 4.5);
  EXPECT_DOUBLE_EQ(signed_distance({-3, 4, 0}, c), 4.5);
  EXPECT_DOUBLE_EQ(signed_distance({1, 0, 0.25}, c), -0.25);
  EXPECT_DOUBLE_EQ(signed_distance({3, 4, 0}, sphere(Point<3>(0, 0, 0), 1)), 4);
}

}  // namespace
}  // namespace clothbench::contact
