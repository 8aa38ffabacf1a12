#include <gtest/gtest.h>

#include <cmath>

#include "xr/painter.hpp"

namespace clothbench::xr {
namespace {

/// A point seen by an eye lies where the field of view's tangents say.
TEST(Views, AnEyesClipSpace) {
  using render::operator*;
  const XrFovf fov{-0.9f, 0.6f, 0.8f, -0.7f};
  const float h = std::sqrt(0.5f);
  const XrPosef pose{{0, h, 0, h}, {1, 2, 3}};  // turned left: it looks along -x
  const Vec3 origin = {0.5, 0, 0};
  const render::Mat4 m = projection_of(fov, 0.1, 50) * view_of(pose, origin);
  const auto clip = [&](Vec3 p) {
    std::array<double, 4> c{};
    for (std::size_t row = 0; row < 4; ++row)
      c[row] =
          m[row] * (p[0] - origin[0]) + m[4 + row] * (p[1] - origin[1]) + m[8 + row] * (p[2] - origin[2]) + m[12 + row];
    return std::array<double, 3>{c[0] / c[3], c[1] / c[3], c[2] / c[3]};
  };
  const double d = 2;
  const auto at = [&](double right, double up) { return Vec3{1 - d, 2 + d * up, 3 - d * right}; };  // its right is -z
  const auto low_left = clip(at(std::tan(-0.9), std::tan(-0.7))), high_right = clip(at(std::tan(0.6), std::tan(0.8)));
  EXPECT_NEAR(low_left[0], -1, 1e-6);
  EXPECT_NEAR(low_left[1], 1, 1e-6) << "y is down";
  EXPECT_NEAR(high_right[0], 1, 1e-6);
  EXPECT_NEAR(high_right[1], -1, 1e-6);
  EXPECT_NEAR(clip({1 - 0.1, 2, 3})[2], 0, 1e-5);
  EXPECT_NEAR(clip({1 - 50, 2, 3})[2], 1, 1e-5);
}

}  // namespace
}  // namespace clothbench::xr
