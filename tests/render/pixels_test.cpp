// Images, pixel by pixel, under core and synchronization validation.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "clothbench/error.hpp"
#include "common/gpu_solver.hpp"
#include "render/camera.hpp"
#include "render/offscreen.hpp"
#include "scenario/cloth_mesh.hpp"
#include "sheets.hpp"

namespace clothbench::render {
namespace {

constexpr int kSize = 128;

class Pixels : public ::testing::Test {
 protected:
  void TearDown() override { EXPECT_EQ(device_->validation_messages(), 0); }

  /// Draws the cloth as seen along z from the side `from`; -1: from behind (the sheet is rotated, not the camera).
  Picture draw(const Cloth& cloth, const std::vector<double>& x, const Surfaces& s = {}) {
    renderer_.set_cloth(cloth, {0, 0, 0});
    renderer_.write_positions(x);
    renderer_.set_surfaces(s);
    return shoot();
  }
  Picture shoot() {
    images_.draw(renderer_, std::span(&camera_, 1));
    return images_.read(0);
  }
  std::array<int, 3> pixel(const Picture& p, const Vec3& point) const {
    const auto at = seen_at(camera_, point);
    const std::uint8_t* c = p.at(static_cast<int>((*at)[0] * kSize), static_cast<int>((*at)[1] * kSize));
    return {c[0], c[1], c[2]};
  }
  static bool orange(const std::array<int, 3>& c) { return c[0] > c[2] + 40; }
  static bool blue(const std::array<int, 3>& c) { return c[2] > c[0] + 40; }
  static bool white(const std::array<int, 3>& c) { return c[0] == 255 && c[1] == 255 && c[2] == 255; }
  static bool grey(const std::array<int, 3>& c) { return !white(c) && std::abs(c[0] - c[2]) < 25; }

  std::shared_ptr<vulkan::Device> device_ = vulkan::Device::get({-1, true});
  SceneRenderer renderer_{device_, Offscreen::kFormat};
  Offscreen images_{device_, {kSize, kSize}, 1};
  Camera camera_ = front_camera();
};

Collider ball(const Vec3& center, double radius) {
  Collider c;
  c.shape = Collider::Shape::Sphere;
  c.center_m = center;
  c.radius_m = radius;
  return c;
}

Surfaces of(const Collider& c) {
  Scene s;
  s.colliders = {c};
  return surfaces(s, 0, {{-2, -2, -2}, {2, 2, 2}});
}

TEST_F(Pixels, SquaresAreLightAndDarkInTurn) {
  const Cloth cloth = upright(9, 9);  // 8 x 8 cells, and as many squares
  const Picture p = draw(cloth, positions_of(cloth));
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i) {
      const auto here = pixel(p, {(i + 0.5) / 8 - 0.5, (j + 0.5) / 8 - 0.5, 0});
      EXPECT_TRUE(orange(here)) << i << " " << j;
      if (i == 7) continue;
      const auto next = pixel(p, {(i + 1.5) / 8 - 0.5, (j + 0.5) / 8 - 0.5, 0});
      EXPECT_GT(std::abs(here[2] - next[2]), 40) << "neighbours differ at " << i << " " << j;
    }
  EXPECT_TRUE(white(pixel(p, {0.8, 0.8, 0})));
}

TEST_F(Pixels, AMeshLooksAsItsGridDoes) {
  Scene s;
  s.cloth = upright(9, 9);
  s.cloth.areal_density_kg_per_m2 = 0.2;
  std::vector<double> x = positions_of(s.cloth);
  for (std::size_t k = 0; k < x.size(); k += 3) x[k + 2] = 0.2 * x[k] * x[k];
  const Picture grid = draw(s.cloth, x), mesh = draw(as_mesh(s).cloth, x);
  int differ = 0, drawn = 0;
  for (int row = 0; row < kSize; ++row)
    for (int column = 0; column < kSize; ++column) {
      const std::uint8_t *a = grid.at(column, row), *b = mesh.at(column, row);
      drawn += a[0] + a[1] + a[2] < 765 ? 1 : 0;
      for (int k = 0; k < 3; ++k)
        if (std::abs(a[k] - b[k]) > 24) {
          ++differ;
          break;
        }
    }
  EXPECT_GT(drawn, 1000);
  EXPECT_LT(differ, drawn / 50) << "different diagonals give slightly different normals";
  x[3 * 40] = NAN;
  EXPECT_TRUE(white(pixel(draw(as_mesh(s).cloth, x), {0.02, 0.01, 0}))) << "triangles with a NaN are not drawn";
  EXPECT_TRUE(orange(pixel(draw(as_mesh(s).cloth, x), {0.4, 0.4, 0.032})));
}

TEST_F(Pixels, BothSidesAreShadedAndToldApart) {
  const Cloth cloth = upright(5, 5);
  std::vector<double> x = positions_of(cloth);
  const auto front = pixel(draw(cloth, x), {0.06, 0.06, 0});
  for (std::size_t k = 0; k < x.size(); k += 3) x[k] = -x[k];  // turned round
  const auto back = pixel(draw(cloth, x), {0.06, 0.06, 0});
  EXPECT_TRUE(orange(front));
  EXPECT_TRUE(blue(back));
  for (const auto& c : {front, back}) EXPECT_GT(std::max(c[0], c[2]), 120) << "lit, not in its own shadow";
}

TEST_F(Pixels, FacesTurnedFromTheLightAreDarker) {
  const Cloth cloth = upright(3, 3);
  const auto brightness = [&](double lean) {
    std::vector<double> x = positions_of(cloth);
    for (std::size_t k = 0; k < x.size(); k += 3) x[k + 2] = lean * x[k + 1];
    const Picture p = draw(cloth, x);
    const auto c = pixel(p, {0.06, 0.06, lean * 0.06});
    return c[0] + c[1] + c[2];
  };
  EXPECT_GT(brightness(-0.8), brightness(0.8) + 30) << "upper edge away from the viewer: lit from above";
}

TEST_F(Pixels, ACollidersHidesWhatIsBehindIt) {
  const Cloth cloth = upright(9, 9);
  const std::vector<double> x = positions_of(cloth);
  EXPECT_TRUE(grey(pixel(draw(cloth, x, of(ball({0, 0, 0.4}, 0.1))), {0, 0, 0.4})));
  EXPECT_TRUE(orange(pixel(draw(cloth, x, of(ball({0, 0, 0.4}, 0.1))), {0.4, 0.4, 0})));
  EXPECT_TRUE(orange(pixel(draw(cloth, x, of(ball({0, 0, -0.4}, 0.1))), {0.06, 0.06, 0})));
  EXPECT_TRUE(grey(pixel(draw(cloth, x, of(ball({0.3, 0, 0}, 0.1))), {0.3, 0, 0.1}))) << "half way through";
}

TEST_F(Pixels, EveryShapeIsThere) {
  const Cloth cloth = upright(2, 2, 0.01, 0.01);
  const std::vector<double> x = positions_of(cloth);
  Collider box, plane, capsules, mesh;
  box.shape = Collider::Shape::Box;
  box.center_m = {0.5, 0.5, 0};
  box.half_extent_m = {0.2, 0.1, 0.1};
  plane.shape = Collider::Shape::Plane;
  plane.center_m = {0, -0.5, 0};
  plane.normal = {0, 0.6, 0.8};
  capsules.shape = Collider::Shape::Capsules;
  capsules.capsules = {{{-0.5, 0.2, 0}, {-0.5, 0.7, 0}, 0.1}};
  mesh.shape = Collider::Shape::Mesh;
  auto triangle = std::make_shared<ColliderMesh>();
  triangle->positions = {0.3, -0.2, 0, 0.7, -0.2, 0, 0.5, 0.2, 0};
  triangle->triangles = {{0, 1, 2}};
  mesh.mesh = triangle;
  EXPECT_TRUE(grey(pixel(draw(cloth, x, of(box)), {0.65, 0.45, 0.1})));
  EXPECT_TRUE(white(pixel(draw(cloth, x, of(box)), {0.78, 0.5, 0.0})));
  EXPECT_TRUE(grey(pixel(draw(cloth, x, of(plane)), {0.3, -0.5, 0})));
  const Picture stick = draw(cloth, x, of(capsules));
  for (const double y : {0.12, 0.45, 0.78}) EXPECT_TRUE(grey(pixel(stick, {-0.5, y, 0}))) << y;
  EXPECT_TRUE(white(pixel(stick, {-0.5, 0.83, 0})));
  EXPECT_TRUE(grey(pixel(draw(cloth, x, of(mesh)), {0.5, -0.1, 0})));
}

TEST_F(Pixels, KnownVerticesAreWhereTheCameraSaysTheyAre) {
  const Cloth cloth = upright(2, 2, 0.6, 0.3);
  std::vector<double> x = positions_of(cloth);
  for (std::size_t k = 0; k < x.size(); k += 3) {
    x[k] += 0.4;
    x[k + 1] -= 0.35;
    x[k + 2] += 0.2;
  }
  const Picture p = draw(cloth, x);
  double low[2] = {kSize, kSize}, high[2] = {0, 0};
  for (int row = 0; row < kSize; ++row)
    for (int column = 0; column < kSize; ++column)
      if (p.at(column, row)[0] + p.at(column, row)[2] < 500) {
        low[0] = std::min<double>(low[0], column);
        low[1] = std::min<double>(low[1], row);
        high[0] = std::max<double>(high[0], column + 1);
        high[1] = std::max<double>(high[1], row + 1);
      }
  const auto first = seen_at(camera_, {x[0], x[1], x[2]}), last = seen_at(camera_, {x[9], x[10], x[11]});
  EXPECT_NEAR(low[0], (*first)[0] * kSize, 1.5);
  EXPECT_NEAR(high[1], (*first)[1] * kSize, 1.5);
  EXPECT_NEAR(high[0], (*last)[0] * kSize, 1.5);
  EXPECT_NEAR(low[1], (*last)[1] * kSize, 1.5);
}

TEST_F(Pixels, EdgesAreAntialiased) {
  const Cloth cloth = upright(2, 2);
  std::vector<double> x = positions_of(cloth);
  for (std::size_t k = 0; k < x.size(); k += 3) x[k + 1] += 0.2 * x[k];  // edges neither horizontal nor vertical
  const Picture p = draw(cloth, x);
  int between = 0;
  const auto at = seen_at(camera_, {0, 0.5, 0});
  for (int row = static_cast<int>((*at)[1] * kSize) - 8; row < (*at)[1] * kSize + 8; ++row)
    for (int column = kSize / 4; column < 3 * kSize / 4; ++column) {
      const int c = p.at(column, row)[2];  // blue of orange squares is below 160
      between += c > 175 && c < 250 ? 1 : 0;
    }
  EXPECT_GT(between, 10);
}

TEST_F(Pixels, WhatIsNotFiniteIsLeftOut) {
  const Cloth cloth = upright(5, 5);
  std::vector<double> x = positions_of(cloth);
  x[3 * 12] = NAN;  // the middle
  x[3 * 4] = INFINITY;
  x[3 * 20 + 1] = 1e30;
  const Picture p = draw(cloth, x);
  EXPECT_TRUE(white(pixel(p, {0.05, 0.03, 0}))) << "all triangles of the middle vertex are gone";
  EXPECT_TRUE(orange(pixel(p, {0.3, 0.05, 0}))) << "and no other";
  for (double& v : x) v = NAN;
  const Picture none = draw(cloth, x);
  for (int k = 0; k < kSize; ++k) EXPECT_TRUE(white({none.at(k, k)[0], none.at(k, k)[1], none.at(k, k)[2]}));
  Collider lost = ball({NAN, 0, 0}, 0.1);
  EXPECT_TRUE(of(lost).triangles.empty());
}

TEST_F(Pixels, SaysWhatDoesNotFit) {
  EXPECT_THROW(shoot(), Error) << "nothing to draw yet";
  renderer_.set_cloth(upright(3, 3), {0, 0, 0});
  EXPECT_THROW(renderer_.write_positions(std::vector<double>(26)), Error);
  EXPECT_THROW(renderer_.set_cloth(upright(1, 3), {0, 0, 0}), Error);
  EXPECT_THROW(Offscreen(device_, {0, 10}, 1), Error);
  EXPECT_THROW(Offscreen(device_, {1u << 20, 10}, 1), Error);
}

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
