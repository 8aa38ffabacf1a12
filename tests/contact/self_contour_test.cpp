// A cloth against itself: figures worked out on paper, and the same pairs as by looking at all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "meshes.hpp"
#include "metrics/contact/contour.hpp"

namespace clothbench::contact {
namespace {

TEST(SelfContour, TwoStripsCrossAlongTheirCommonLine) {
  // Level, 1 m x 0.2 m; upright at x = 0.37 from z = 0.05 to 0.5: they cross from z = 0.05 to 0.2.
  const Mesh level = sheet(9, 3, Point<3>(0, 0, 0), Point<3>(1, 0, 0), Point<3>(0, 0, 0.2));
  const Mesh upright = sheet(4, 7, Point<3>(0.37, -0.1, 0.05), Point<3>(0, 0.21, 0), Point<3>(0, 0, 0.45));
  const Contour c = self_contour(together(level, upright).view());
  EXPECT_NEAR(c.length_m, 0.15, 1e-12);
  EXPECT_GT(c.pairs, 3);
  const Contour apart = self_contour(together(level, upright.moved(Point<3>(0, 0.2, 0))).view());
  EXPECT_EQ(apart.pairs, 0);
  EXPECT_EQ(apart.length_m, 0);
}

TEST(SelfContour, FlatRolledAndFoldedClothCrossesNowhere) {
  const Mesh flat = sheet(12, 12, Point<3>(0, 0, 0), Point<3>(1, 0, 0), Point<3>(0, 0, 1));
  const Mesh rolled = flat.mapped([](const Point<3>& p) {
    const double turn = 15 * p[0], r = 0.05 + 0.02 * p[0];
    return Point<3>(r * std::cos(turn), r * std::sin(turn), p[2]);
  });
  const Mesh folded =
      flat.mapped([](const Point<3>& p) { return Point<3>(std::abs(p[0] - 0.5), 0.01 * (p[0] - 0.5), p[2]); });
  for (const Mesh* m : {&flat, &rolled, &folded}) {
    EXPECT_EQ(self_contour(m->view()).pairs, 0);
    EXPECT_EQ(self_contour(m->view()).length_m, 0);
  }
  // Folded flat, layer on layer: they touch, and cross nowhere.
  const Mesh pressed = flat.mapped([](const Point<3>& p) { return Point<3>(std::abs(p[0] - 0.5), 0, p[2]); });
  EXPECT_GT(self_contour(pressed.view()).pairs, 100);
  EXPECT_EQ(self_contour(pressed.view()).length_m, 0);
}

TEST(SelfContour, FindsThePairsThatLookingAtAllFinds) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-0.3, 0.3);
  const Mesh crumpled =
      sheet(7, 6, Point<3>(0, 0, 0), Point<3>(1, 0, 0), Point<3>(0, 0, 1)).mapped([&](const Point<3>& p) {
        return Point<3>(p + Point<3>(any(random), any(random), any(random)));
      });
  Contour all;
  for (std::size_t a = 0; a < crumpled.triangles.size(); ++a)
    for (std::size_t b = a + 1; b < crumpled.triangles.size(); ++b) {
      const auto &first = crumpled.triangles[a], &second = crumpled.triangles[b];
      if (std::find_first_of(first.begin(), first.end(), second.begin(), second.end()) != first.end()) continue;
      const Mesh one{crumpled.positions, {first}}, other{crumpled.positions, {second}};
      const Contour c = contour(one.view(), TriangleTree(other.view()));
      all.pairs += c.pairs;
      all.length_m += c.length_m;
    }
  const Contour c = self_contour(crumpled.view());
  EXPECT_GT(all.pairs, 50);
  EXPECT_EQ(c.pairs, all.pairs);
  EXPECT_NEAR(c.length_m, all.length_m, 1e-9);
}

}  // namespace
}  // namespace clothbench::contact
