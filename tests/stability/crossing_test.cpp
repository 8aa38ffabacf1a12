#include "metrics/stability/crossing.hpp"

#include <gtest/gtest.h>

namespace clothbench::stability {
namespace {

const std::array<Vec3, 3> kTriangle = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};  // normal +z

std::array<Vec3, 3> lifted(double z) {
  std::array<Vec3, 3> t = kTriangle;
  for (Vec3& v : t) v[2] += z;
  return t;
}

TEST(Passes, CountAlongAndAgainstTheNormal) {
  EXPECT_EQ(passes({0.2, 0.2, -1}, {0.2, 0.2, 1}, kTriangle, kTriangle), 1);
  EXPECT_EQ(passes({0.2, 0.2, 1}, {0.2, 0.2, -1}, kTriangle, kTriangle), -1);
  EXPECT_EQ(passes({2, 2, -1}, {2, 2, 1}, kTriangle, kTriangle), 0);
  EXPECT_EQ(passes({0.2, 0.2, 0.5}, {0.2, 0.2, 1}, kTriangle, kTriangle), 0);
}

TEST(Passes, AreRelative) {
  // The cloth goes before the point: neither passes the other, however far both go.
  EXPECT_EQ(passes({0.2, 0.2, -0.1}, {0.2, 0.2, 1.6}, kTriangle, lifted(1.7)), 0);
  // The cloth falls past a static point.
  EXPECT_EQ(passes({0.2, 0.2, 0}, {0.2, 0.2, 0}, lifted(1), lifted(-1)), 1);
}

Scene scene_with(double from_z, double to_z) {
  Scene s;
  s.cloth.columns = s.cloth.rows = 3;
  s.cloth.width_m = s.cloth.height_m = 1;
  s.cloth.axis_u = {1, 0, 0};
  s.cloth.axis_v = {0, 1, 0};
  s.time.frame_rate_hz = 60;
  s.time.duration_s = 2.0 / 60;
  Collider ball;
  ball.shape = Collider::Shape::Capsules;
  ball.capsules = {{{0.1, 0.05, from_z}, {0.1, 0.06, from_z}, 0.1}};
  s.colliders = {ball};
  for (double z : {from_z, to_z, from_z}) {
    FrameMotion m;
    m.colliders = {{{{{0.1, 0.05, z}, {0.1, 0.06, z}, 0.1}}, {}}};
    s.motion.push_back(m);
  }
  return s;
}

TEST(CapsuleCrossing, ThereIsOneAndBackIsNone) {
  const Scene s = scene_with(-0.5, 0.5);
  CapsuleCrossing crossing(s);
  const std::vector<double> x = initial_positions(s);
  EXPECT_EQ(crossing.add(0, x), 0);
  EXPECT_EQ(crossing.add(1, x), 1);
  EXPECT_EQ(crossing.add(2, x), 0);
}

TEST(CapsuleCrossing, ATeleportIsNoPath) {
  Scene s = scene_with(-0.5, 0.5);
  s.jumps = {{1, 1.0}};
  CapsuleCrossing crossing(s);
  const std::vector<double> x = initial_positions(s);
  crossing.add(0, x);
  EXPECT_EQ(crossing.add(1, x), 0);
}

}  // namespace
}  // namespace clothbench::stability
