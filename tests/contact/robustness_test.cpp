#include <gtest/gtest.h>

#include "clothbench/error.hpp"
#include "meshes.hpp"
#include "metrics/contact/contact_probe.hpp"

namespace clothbench::contact {
namespace {

/// A wavy cloth through a bumpy ball: every figure is nonzero and nothing is special.
Mesh wavy(int cells) {
  return sheet(cells, cells, {-0.3, 0.11, -0.3}, {0, 0, 0.6}, {0.6, 0, 0}).mapped([](const Point<3>& p) {
    return Point<3>(p + Point<3>(0.003, 0.02 * std::sin(14 * p[0] + 3 * p[2]), 0.001));
  });
}

std::array<double, 2> fields(const ContactSample& s) { return {s.contour_length_m, s.depth_max_m}; }

ContactSample sample(const Mesh& cloth, const Mesh& object) {
  return ContactProbe(cloth.view(), object.view()).probe(cloth.positions);
}

TEST(Robustness, CoincidentCopiesStayFinite) {
  const int cells = 8;
  const Mesh flat = patch(cells), bent = wavy(cells);
  EXPECT_EQ(sample(flat, flat).contour_length_m, 0);
  // No more than all edges together.
  const double edges = 3 * 0.6 * (cells + 1) * 1.5, length = sample(bent, bent).contour_length_m;
  EXPECT_TRUE(length >= 0 && length <= edges) << length;
}

TEST(Robustness, ShiftedInItsOwnPlaneHasNoContour) {
  EXPECT_EQ(sample(patch(8), patch(7).moved({0.01, 0, 0.02})).contour_length_m, 0);
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
  const ContactSample plain = sample(cloth, ball), other = sample(cloth, worse);
  const auto p = fields(plain), q = fields(other);
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_GT(p[i], 0) << i;
    EXPECT_NEAR(p[i], q[i], 1e-12 * p[i]) << i;
  }
  // On the cloth's side too: a cell that has fallen together.
  Mesh collapsed = cloth;
  for (int k = 0; k < 3; ++k) collapsed.positions[3 * 200 + k] = collapsed.positions[3 * 201 + k];
  for (const double x : fields(sample(collapsed, ball))) EXPECT_TRUE(std::isfinite(x));
}

TEST(Robustness, NotFiniteIsNaN) {
  const Mesh cloth = wavy(8), ball = bumpy_ball(6, 0.15);
  const Capsule shape = sphere(Point<3>::Zero(), 0.15);
  const ContactProbe mesh(cloth.view(), ball.view()), shapes(cloth.view(), {&shape, 1});
  for (const double bad : std::initializer_list<double>{std::nan(""), INFINITY, -INFINITY})
    for (const ContactProbe* probe : {&mesh, &shapes}) {
      std::vector<double> broken = cloth.positions;
      broken[17] = bad;
      for (const double x : fields(probe->probe(broken))) EXPECT_TRUE(std::isnan(x));
      EXPECT_GT(probe->probe(cloth.positions).contour_length_m, 0);
    }
}

TEST(Robustness, FarTooLargePositionsAreFiniteOrInfiniteButNotNaN) {
  const Mesh cloth = wavy(8), ball = bumpy_ball(6, 0.15);
  const ContactProbe probe(cloth.view(), ball.view());
  std::vector<double> burst = cloth.positions;
  for (std::size_t i = 0; i < burst.size(); ++i) burst[i] *= i % 2 ? 1e60 : -1e60;
  for (const double x : fields(probe.probe(burst))) EXPECT_FALSE(std::isnan(x));
}

// A power of two changes exponents alone.
TEST(Robustness, ScaleInvarianceBitForBit) {
  const Mesh cloth = wavy(20), ball = bumpy_ball(10, 0.15);
  const ContactSample one = sample(cloth, ball);
  for (const double k : {0x1p-20, 0x1p+10}) {
    const auto scaled = [k](const Mesh& m) { return m.mapped([k](const Point<3>& p) { return Point<3>(k * p); }); };
    const ContactSample s = sample(scaled(cloth), scaled(ball));
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
  const auto here = fields(sample(cloth, ball));
  const auto there = fields(sample(moved(cloth), moved(ball)));
  for (std::size_t i = 0; i < here.size(); ++i) {
    EXPECT_GT(here[i], 0) << i;
    EXPECT_NEAR(here[i], there[i], 1e-9 * here[i]) << i;
  }
  const Capsule c{{-0.05, 0.01, 0.02}, {0.06, -0.02, 0.03}, 0.14}, t{turn * c.a + shift, turn * c.b + shift, 0.14};
  const auto shape = fields(ContactProbe(cloth.view(), {&c, 1}).probe(cloth.positions));
  const Mesh turned = moved(cloth);
  const auto turned_shape = fields(ContactProbe(turned.view(), {&t, 1}).probe(turned.positions));
  // The sides of its triangles lie elsewhere.
  EXPECT_NEAR(shape[0], turned_shape[0], 0.02 * shape[0]);
  EXPECT_NEAR(shape[1], turned_shape[1], 1e-9 * shape[1]);
}

TEST(Robustness, EmptyObjects) {
  const Mesh cloth = wavy(8), nothing;
  ContactProbe mesh(cloth.view(), nothing.view()), shapes(cloth.view(), std::span<const Capsule>());
  for (ContactProbe* probe : {&mesh, &shapes}) {
    const ContactSample s = probe->probe(cloth.positions);
    EXPECT_EQ(s.contour_length_m, 0);
  }
  EXPECT_FALSE(mesh.has_inside());
  Mesh one;
  one.triangles.push_back({one.add({-1, 0.1, -1}), one.add({1, 0.12, -1}), one.add({0, 0.11, 1})});
  EXPECT_GT(ContactProbe(cloth.view(), one.view()).probe(cloth.positions).contour_length_m, 0);
}

TEST(Robustness, ErrorsNameWhatWasExpected) {
  const Mesh cloth = wavy(4), ball = bumpy_ball(3, 0.1);
  Mesh bad_index = ball, bad_number = ball, no_area = cloth;
  bad_index.triangles[5][1] = 100000;
  bad_number.positions[4] = std::nan("");
  for (double& x : no_area.positions) x = 1;
  EXPECT_THROW(ContactProbe(cloth.view(), bad_index.view()), Error);
  EXPECT_THROW(ContactProbe(bad_index.view(), ball.view()), Error);
  EXPECT_THROW(ContactProbe(cloth.view(), bad_number.view()), Error);
  EXPECT_THROW(ContactProbe(no_area.view(), ball.view()), Error);
  const Capsule shape = sphere(Point<3>::Zero(), 0.1), negative = sphere(Point<3>::Zero(), -1);
  EXPECT_THROW(ContactProbe(cloth.view(), {&negative, 1}), Error);
  ContactProbe mesh(cloth.view(), ball.view()), shapes(cloth.view(), {&shape, 1});
  EXPECT_THROW(mesh.move_object(cloth.positions), Error);
  EXPECT_THROW(mesh.move_object(bad_number.positions), Error);
  EXPECT_THROW(mesh.move_shapes({&shape, 1}), Error);
  EXPECT_THROW(shapes.move_object(ball.positions), Error);
  EXPECT_THROW(shapes.move_shapes({}), Error);
  EXPECT_THROW(mesh.probe(ball.positions), Error);
  try {
    ContactProbe(cloth.view(), bad_index.view());
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("triangle 5 names vertex 100000"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace clothbench::contact
