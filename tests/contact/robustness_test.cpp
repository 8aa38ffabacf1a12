#include <gtest/gtest.h>

#include "meshes.hpp"
#include "refusal.hpp"

namespace clothbench::contact {
namespace {

/// A wavy cloth through a bumpy ball: every figure is nonzero and nothing is special.
Mesh wavy(int cells) {
  return sheet(cells, cells, {-0.3, 0.11, -0.3}, {0, 0, 0.6}, {0.6, 0, 0}).mapped([](const Point<3>& p) {
    return Point<3>(p + Point<3>(0.003, 0.02 * std::sin(14 * p[0] + 3 * p[2]), 0.001));
  });
}

std::array<double, 2> fields(const ContactSample& s) { return {s.contour_length_m, s.depth_max_m}; }

TEST(Robustness, CoincidentCopiesStayFinite) {
  const int cells = 8;
  const Mesh flat = patch(cells), bent = wavy(cells);
  EXPECT_EQ(against(flat, flat).contour_length_m, 0);
  // No more than all edges together.
  const double edges = 3 * 0.6 * (cells + 1) * 1.5, length = against(bent, bent).contour_length_m;
  EXPECT_TRUE(length >= 0 && length <= edges) << length;
}

TEST(Robustness, DegenerateAndUnsharedTrianglesChangeNothing) {
  const Mesh cloth = wavy(20), ball = bumpy_ball(10, 0.15);
  Mesh worse = unshared(ball);
  for (std::size_t t = 0; t < 200; ++t) {
    const Simplex<3> v = ball.view().triangle(t);
    const auto a = worse.add(v[0]), b = worse.add(v[1]);
    worse.triangles.push_back({a, b, b});
    worse.triangles.push_back({a, a, a});
    worse.triangles.push_back({a, b, worse.add(v[0])});
  }
  const ContactSample plain = against(cloth, ball), other = against(cloth, worse);
  const auto p = fields(plain), q = fields(other);
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_GT(p[i], 0) << i;
    EXPECT_NEAR(p[i], q[i], 1e-12 * p[i]) << i;
  }
  // On the cloth's side too: a cell that has fallen together.
  Mesh collapsed = cloth;
  for (int k = 0; k < 3; ++k) collapsed.positions[3 * 200 + k] = collapsed.positions[3 * 201 + k];
  for (const double x : fields(against(collapsed, ball))) EXPECT_TRUE(std::isfinite(x));
}

TEST(Robustness, NotFiniteIsNaN) {
  const Mesh cloth = wavy(8), ball = bumpy_ball(6, 0.15);
  const Capsule shape = sphere(Point<3>::Zero(), 0.15);
  for (const double bad : std::initializer_list<double>{std::nan(""), INFINITY, -INFINITY}) {
    Mesh broken = cloth;
    broken.positions[17] = bad;
    for (const ContactSample& s : {against(broken, ball), capsule_contact(broken.view(), {&shape, 1}),
                                   half_space_contact(broken.view(), {0, 0, 0}, {0, 1, 0})})
      for (const double x : fields(s)) EXPECT_TRUE(std::isnan(x));
  }
  Mesh burst = cloth;
  for (std::size_t i = 0; i < burst.positions.size(); ++i) burst.positions[i] *= i % 2 ? 1e60 : -1e60;
  for (const double x : fields(against(burst, ball))) EXPECT_FALSE(std::isnan(x)) << "far too large, but finite";
}

// A power of two changes only exponents.
TEST(Robustness, ScaleInvarianceBitForBit) {
  const Mesh cloth = wavy(20), ball = bumpy_ball(10, 0.15);
  const ContactSample one = against(cloth, ball);
  for (const double k : {0x1p-20, 0x1p+10}) {
    const auto scaled = [k](const Mesh& m) { return m.mapped([k](const Point<3>& p) { return Point<3>(k * p); }); };
    const ContactSample s = against(scaled(cloth), scaled(ball));
    EXPECT_EQ(s.contour_length_m, k * one.contour_length_m);
    EXPECT_EQ(s.depth_max_m, k * one.depth_max_m);
  }
}

TEST(Robustness, RotationAndTranslationInvariance) {
  const Mesh cloth = wavy(20), ball = bumpy_ball(10, 0.15);
  const Eigen::Matrix3d turn = some_rotation();
  const Point<3> shift(0.37, -0.21, 0.93);
  const auto moved = [&](const Mesh& m) {
    return m.mapped([&](const Point<3>& p) { return Point<3>(turn * p + shift); });
  };
  const auto here = fields(against(cloth, ball));
  const auto there = fields(against(moved(cloth), moved(ball)));
  for (std::size_t i = 0; i < here.size(); ++i) {
    EXPECT_GT(here[i], 0) << i;
    EXPECT_NEAR(here[i], there[i], 1e-9 * here[i]) << i;
  }
  const Capsule c{{-0.05, 0.01, 0.02}, {0.06, -0.02, 0.03}, 0.14}, t{turn * c.a + shift, turn * c.b + shift, 0.14};
  const auto shape = fields(capsule_contact(cloth.view(), {&c, 1}));
  const Mesh turned = moved(cloth);
  const auto turned_shape = fields(capsule_contact(turned.view(), {&t, 1}));
  // The sides of its triangles lie elsewhere.
  EXPECT_NEAR(shape[0], turned_shape[0], 0.02 * shape[0]);
  EXPECT_NEAR(shape[1], turned_shape[1], 1e-9 * shape[1]);
}

TEST(Robustness, EmptyAndDamagedObjects) {
  const Mesh cloth = wavy(8), ball = bumpy_ball(3, 0.1);
  EXPECT_EQ(against(cloth, Mesh{}).contour_length_m, 0);
  EXPECT_EQ(capsule_contact(cloth.view(), {}).contour_length_m, 0);
  Mesh bad_index = ball, bad_number = ball;
  bad_index.triangles[5][1] = 100000;
  bad_number.positions[4] = std::nan("");
  EXPECT_THROW(TriangleTree(bad_number.view()), Error);
  EXPECT_PRED2(mentions, refusal([&] { TriangleTree tree(bad_index.view()); }), "triangle 5 names vertex 100000");
}

}  // namespace
}  // namespace clothbench::contact
