#include <gtest/gtest.h>

#include <bit>

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

std::vector<double> fields(const ContactSample& s) {
  const auto numbers = std::bit_cast<std::array<double, sizeof(ContactSample) / sizeof(double)>>(s);
  return {numbers.begin(), numbers.end()};
}

/// From 0.4 above to where it lies.
ContactSample dropped(const Mesh& cloth, const Mesh& object, const Point<3>& up) {
  ContactProbe probe(cloth.view(), object.view());
  probe.probe(cloth.moved(up).positions);
  return probe.probe(cloth.positions);
}

TEST(Robustness, CoincidentCopiesStayFinite) {
  const int cells = 8;
  const Mesh flat = patch(cells), bent = wavy(cells);
  for (const Mesh& mesh : {flat, bent}) {
    const ContactSample s = ContactProbe(mesh.view(), mesh.view()).probe(mesh.positions);
    // A triangle touches itself and the twelve around it, so many pairs and not every one with every other.
    EXPECT_GE(s.pairs, mesh.triangles.size());
    EXPECT_LE(s.pairs, 13 * mesh.triangles.size());
    EXPECT_EQ(s.cloth_fraction, 1);
    EXPECT_EQ(s.tunnelled_fraction, 0);
  }
  EXPECT_EQ(ContactProbe(flat.view(), flat.view()).probe(flat.positions).contour_length_m, 0);
  // No more than all edges together.
  const double edges = 3 * 0.6 * (cells + 1) * 1.5;
  const ContactSample s = ContactProbe(bent.view(), bent.view()).probe(bent.positions);
  EXPECT_TRUE(s.contour_length_m >= 0 && s.contour_length_m <= edges) << s.contour_length_m;
}

TEST(Robustness, ShiftedInItsOwnPlaneHasNoContour) {
  const Mesh a = patch(8), b = patch(7).moved({0.01, 0, 0.02});
  const ContactSample s = ContactProbe(a.view(), b.view()).probe(a.positions);
  EXPECT_EQ(s.contour_length_m, 0);
  EXPECT_GE(s.pairs, a.triangles.size() / 2);
  EXPECT_LE(s.pairs, a.triangles.size() * 20);
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
  const ContactSample plain = dropped(cloth, ball, {0, 0.4, 0}), other = dropped(cloth, worse, {0, 0.4, 0});
  const auto p = fields(plain), q = fields(other);
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_GT(p[i], 0) << i;
    EXPECT_NEAR(p[i], q[i], 1e-12 * p[i]) << i;
  }
  // On the cloth's side too: a cell that has fallen together.
  Mesh collapsed = cloth;
  for (int k = 0; k < 3; ++k) collapsed.positions[3 * 200 + k] = collapsed.positions[3 * 201 + k];
  for (const double x : fields(dropped(collapsed, ball, {0, 0.4, 0}))) EXPECT_TRUE(std::isfinite(x));
}

TEST(Robustness, NotFiniteIsNaNAndLosesTheHistory) {
  const Mesh cloth = wavy(8), ball = bumpy_ball(6, 0.15);
  const Capsule shape = sphere(Point<3>::Zero(), 0.15);
  for (const double bad : std::initializer_list<double>{std::nan(""), INFINITY, -INFINITY}) {
    ContactProbe mesh(cloth.view(), ball.view()), shapes(cloth.view(), {&shape, 1});
    for (ContactProbe* probe : {&mesh, &shapes}) {
      for (const double x : fields(probe->probe(cloth.positions))) EXPECT_FALSE(std::isnan(x));
      std::vector<double> broken = cloth.positions;
      broken[17] = bad;
      for (const double x : fields(probe->probe(broken))) EXPECT_TRUE(std::isnan(x));
      const ContactSample after = probe->probe(cloth.positions);
      EXPECT_GT(after.contour_length_m, 0);
      EXPECT_EQ(std::isnan(after.tunnelled_fraction), probe == &mesh);
      probe->reset();
      EXPECT_FALSE(std::isnan(probe->probe(cloth.positions).tunnelled_fraction));
    }
  }
}

TEST(Robustness, FarTooLargePositionsAreFiniteOrInfiniteButNotNaN) {
  const Mesh cloth = wavy(8), ball = bumpy_ball(6, 0.15);
  ContactProbe probe(cloth.view(), ball.view());
  probe.probe(cloth.positions);
  std::vector<double> burst = cloth.positions;
  for (std::size_t i = 0; i < burst.size(); ++i) burst[i] *= i % 2 ? 1e60 : -1e60;
  for (const double x : fields(probe.probe(burst))) EXPECT_FALSE(std::isnan(x));
}

// A power of two changes exponents alone.
TEST(Robustness, ScaleInvarianceBitForBit) {
  const Mesh cloth = wavy(20), ball = bumpy_ball(10, 0.15);
  const ContactSample one = dropped(cloth, ball, {0, 0.4, 0});
  for (const double k : {0x1p-20, 0x1p+10}) {
    const auto scaled = [k](const Mesh& m) { return m.mapped([k](const Point<3>& p) { return Point<3>(k * p); }); };
    const ContactSample s = dropped(scaled(cloth), scaled(ball), {0, 0.4 * k, 0});
    EXPECT_EQ(s.contour_length_m, k * one.contour_length_m);
    EXPECT_EQ(s.pairs, one.pairs);
    EXPECT_EQ(s.cloth_fraction, one.cloth_fraction);
    EXPECT_EQ(s.tunnelled_fraction, one.tunnelled_fraction);
    EXPECT_EQ(s.tunnelled_depth_max_m, k * one.tunnelled_depth_max_m);
    EXPECT_EQ(s.depth_max_m, k * one.depth_max_m);
    EXPECT_EQ(s.depth_vertex_max_m, k * one.depth_vertex_max_m);
    EXPECT_EQ(s.depth_p99_m, k * one.depth_p99_m);
    EXPECT_EQ(s.depth_mean_m, k * one.depth_mean_m);
    EXPECT_EQ(s.area_m2, k * k * one.area_m2);
    EXPECT_EQ(s.area_fraction, one.area_fraction);
  }
}

TEST(Robustness, RotationAndTranslationInvariance) {
  const Mesh cloth = wavy(20), ball = bumpy_ball(10, 0.15);
  const Eigen::Matrix3d turn = some_rotation();
  const Point<3> shift(0.37, -0.21, 0.93);
  const auto moved = [&](const Mesh& m) {
    return m.mapped([&](const Point<3>& p) { return Point<3>(turn * p + shift); });
  };
  const auto here = fields(dropped(cloth, ball, {0, 0.4, 0}));
  const auto there = fields(dropped(moved(cloth), moved(ball), turn * Point<3>(0, 0.4, 0)));
  for (std::size_t i = 0; i < here.size(); ++i) {
    EXPECT_GT(here[i], 0) << i;
    EXPECT_NEAR(here[i], there[i], 1e-9 * here[i]) << i;
  }
  const Capsule c{{-0.05, 0.01, 0.02}, {0.06, -0.02, 0.03}, 0.14}, t{turn * c.a + shift, turn * c.b + shift, 0.14};
  const auto shape = fields(ContactProbe(cloth.view(), {&c, 1}).probe(cloth.positions));
  const Mesh turned = moved(cloth);
  const auto turned_shape = fields(ContactProbe(turned.view(), {&t, 1}).probe(turned.positions));
  for (std::size_t i = 0; i < shape.size(); ++i) EXPECT_NEAR(shape[i], turned_shape[i], 1e-9 * shape[i]) << i;
}

TEST(Robustness, EmptyObjects) {
  const Mesh cloth = wavy(8), nothing;
  ContactProbe mesh(cloth.view(), nothing.view()), shapes(cloth.view(), std::span<const Capsule>());
  for (ContactProbe* probe : {&mesh, &shapes}) {
    const ContactSample s = probe->probe(cloth.positions);
    EXPECT_EQ(s.contour_length_m, 0);
    EXPECT_EQ(s.pairs, 0);
    EXPECT_EQ(s.tunnelled_fraction, 0);
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
