#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/sha256.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {
namespace {

Scene sheet(int columns, int rows, double width, double height) {
  Scene s;
  s.cloth.columns = columns;
  s.cloth.rows = rows;
  s.cloth.width_m = width;
  s.cloth.height_m = height;
  s.cloth.areal_density_kg_per_m2 = 0.2;
  s.cloth.axis_u = {1, 0, 0};
  s.cloth.axis_v = {0, 0, 1};
  return s;
}

TEST(Geometry, MassesAddUpToDensityTimesArea) {
  for (const auto& [columns, rows] : {std::pair{2, 2}, {3, 2}, {7, 5}, {33, 17}, {128, 128}}) {
    const Scene s = sheet(columns, rows, 1.5, 0.7);
    const std::vector<double> m = vertex_masses(s);
    ASSERT_EQ(m.size(), s.cloth.vertex_count());
    const double expected = 0.2 * 1.5 * 0.7;
    EXPECT_NEAR(std::accumulate(m.begin(), m.end(), 0.0), expected, 1e-12 * expected);
    EXPECT_DOUBLE_EQ(m.front(), m.back());
  }
}

TEST(Geometry, EdgesAreCompleteAndAtRest) {
  const Scene s = sheet(7, 5, 1.2, 0.8);
  const std::vector<double> x = initial_positions(s);
  const std::pair<EdgeKind, std::size_t> expected[] = {
      {EdgeKind::Structural, 6 * 5 + 7 * 4}, {EdgeKind::Shear, 2 * 6 * 4}, {EdgeKind::SkipOne, 5 * 5 + 7 * 3}};
  for (const auto& [kind, count] : expected) {
    const auto all = edges(s.cloth, kind);
    EXPECT_EQ(all.size(), count);
    std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
    for (const Edge& e : all) {
      EXPECT_TRUE(seen.insert(std::minmax(e.a, e.b)).second) << "an edge stands twice";
      const double l =
          std::hypot(x[3 * e.a] - x[3 * e.b], x[3 * e.a + 1] - x[3 * e.b + 1], x[3 * e.a + 2] - x[3 * e.b + 2]);
      EXPECT_NEAR(l, e.rest_m, 1e-14);
    }
  }
}

TEST(Geometry, TrianglesAreWoundAlikeAndCoverTheSheet) {
  const Scene s = sheet(5, 4, 2, 1);
  const std::vector<double> x = initial_positions(s);
  double area = 0;
  for (const auto& t : triangles(s.cloth)) {
    // axis_u x axis_v = -y for this pose
    const auto d = [&](int k, int c) { return x[3 * t[k] + c] - x[3 * t[0] + c]; };
    const double ny = d(1, 2) * d(2, 0) - d(1, 0) * d(2, 2);
    EXPECT_LT(ny, 0);
    area -= ny / 2;
  }
  EXPECT_NEAR(area, 2.0, 1e-13);
}

TEST(Geometry, Sha256AgreesWithThePublishedVectors) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256(std::string(1000000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

}  // namespace
}  // namespace clothbench
