#include <gtest/gtest.h>

#include "meshes.hpp"
#include "metrics/contact/contact_probe.hpp"
#include "refusal.hpp"

namespace clothbench::contact {
namespace {

Capsule sphere(const Point<3>& centre, double radius_m) { return {centre, centre, radius_m}; }

/// A wavy cloth through a bumpy ball: every value is nonzero, and nothing is degenerate.
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
  // At most the length of all edges together.
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
  // The cloth may have a degenerate cell, too.
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

// Scaling by a power of two changes only exponents.
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
  // After the rotation, the edges of the capsule's triangles are elsewhere.
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

// A flat sheet pushed by d into a sphere of radius R: the contour is a circle of radius sqrt(2Rd - d^2).

constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 0.1;

double exact_contour(double d) { return 2 * kPi * std::sqrt(2 * kRadius * d - d * d); }

/// A horizontal sheet d below the sphere's top, a vertex under the top, cells not aligned with the sphere's triangles.
Mesh lowered_sheet(int cells, double d) {
  const double c = std::cos(0.3), s = std::sin(0.3), side = 0.24;
  const Point<3> u(side * c, 0, -side * s), v(side * s, 0, side * c);
  return sheet(cells, cells, Point<3>(0, kRadius - d, 0) - 0.5 * (u + v), v, u);
}

/// A sphere rotated so that the plane cuts it in general position, but with a vertex on top, the deepest point.
Mesh ball(int n) {
  const Mesh plain = octasphere(n, kRadius);
  const Point<3> top = plain.view().vertex(plain.triangles[n][0]).normalized();
  const Eigen::Matrix3d turn = Eigen::Quaterniond::FromTwoVectors(top, Point<3>::UnitY()).toRotationMatrix();
  return plain.mapped([&](const Point<3>& p) { return Point<3>(turn * p); });
}

ContactSample mesh_sample(int level, double d) {
  const Mesh cloth = lowered_sheet(24 << level, d), object = ball(20 << level);
  return against(cloth, object);
}

/// Three levels, each with twice the resolution of the one before: observed order 2 +- 0.3.
TEST(UnitNumbers, SphereMesh) {
  for (const double d : {0.005, 0.01, 0.02}) {
    const double exact = exact_contour(d);
    const ContactSample s[3] = {mesh_sample(0, d), mesh_sample(1, d), mesh_sample(2, d)};
    const double coarse = std::abs(s[0].contour_length_m - exact), fine = std::abs(s[2].contour_length_m - exact);
    EXPECT_LE(fine, 2e-3 * exact) << d;
    EXPECT_LE(std::abs(std::log2(coarse / fine) / 2 - 2), 0.3) << d;
    EXPECT_LE(std::abs(s[2].depth_max_m - d), 1e-4 * kRadius) << d;
  }
}

/// The contour of a capsule's triangles is at most as long as the exact capsule's contour, and at least as long as the
/// contour of a capsule whose radius is smaller by the stated error.
void expect_contour(double found, double at_radius, double at_less, const char* what) {
  EXPECT_LE(found, at_radius * (1 + 1e-12)) << what;
  EXPECT_GE(found, at_less * (1 - kCapsuleError)) << what;
}

// Horizontal sheets in a sphere, through a capsule along x (a stadium), and through an upright capsule.
TEST(UnitNumbers, CapsulesByTriangles) {
  const double length = 0.3, less = (1 - kCapsuleError) * kRadius;
  const Capsule ball = sphere(Point<3>::Zero(), kRadius), lying{{-length / 2, 0, 0}, {length / 2, 0, 0}, kRadius},
                upright{{0, -length, 0}, {0, 0, 0}, kRadius};
  const auto sample = [](const Mesh& cloth, const Capsule& c) { return capsule_contact(cloth.view(), {&c, 1}); };
  const auto half_width = [](double radius, double height) {
    return radius > height ? std::sqrt(radius * radius - height * height) : 0;
  };
  for (const double d : {1e-5, 1e-4, 0.001, 0.003, 0.005, 0.01, 0.02, 0.07}) {
    const double a = half_width(kRadius, kRadius - d), b = half_width(less, kRadius - d);
    const Mesh cloth = lowered_sheet(6, d), wide = sheet(16, 16, {-0.35, kRadius - d, -0.25}, {0, 0, 0.5}, {0.7, 0, 0});
    for (const Capsule& round : {ball, upright}) {
      const ContactSample s = sample(cloth, round);
      expect_contour(s.contour_length_m, 2 * kPi * a, 2 * kPi * b, "circle");
      EXPECT_NEAR(s.depth_max_m, d, 1e-12);
    }
    const ContactSample s = sample(wide, lying);
    expect_contour(s.contour_length_m, 2 * kPi * a + 2 * length, b > 0 ? 2 * kPi * b + 2 * length : 0, "stadium");
    EXPECT_NEAR(s.depth_max_m, d, 1e-12);
  }
}

TEST(UnitNumbers, CapsuleMeshIsWithinItsError) {
  for (const Capsule& c : {sphere({0.1, -0.2, 0.3}, 0.02), Capsule{{0, 0, 0}, {0.3, 0.1, -0.2}, 0.05}}) {
    const CapsuleMesh mesh = capsule_mesh(c);
    EXPECT_TRUE(is_inside(c.a, TriangleTree(mesh.view())));
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Simplex<3> v = mesh.view().triangle(t);
      const Point<3> out = (v[1] - v[0]).cross(v[2] - v[0]), middle = (v[0] + v[1] + v[2]) / 3;
      for (const Point<3>& p : {v[0], Point<3>(0.5 * (v[0] + v[1])), Point<3>(0.5 * (v[1] + v[2])),
                                Point<3>(0.5 * (v[2] + v[0])), middle}) {
        EXPECT_LE(signed_distance(p, c), 1e-12);
        EXPECT_GE(signed_distance(p, c), -kCapsuleError * c.radius_m);
      }
      EXPECT_GT(signed_distance(middle + 1e-3 * c.radius_m * out.normalized(), c), signed_distance(middle, c))
          << "seen from outside";
    }
  }
}

// Two separate spheres count twice, a duplicate changes nothing, and contour inside the other capsule does not count.
TEST(UnitNumbers, UnionOfCapsules) {
  const Mesh cloth = sheet(40, 20, {-0.5, 0.09, -0.25}, {0, 0, 0.5}, {1, 0, 0});
  const Capsule left = sphere({-0.22, 0, 0}, kRadius), right = sphere({0.21, 0, 0}, kRadius);
  const auto length = [&](std::vector<Capsule> shapes) {
    return capsule_contact(cloth.view(), shapes).contour_length_m;
  };
  EXPECT_NEAR(length({left, right}), length({left}) + length({right}), 1e-12);
  EXPECT_EQ(length({left, right, left}), length({left, right}));
  // A finger of two capsules with a common joint has the contour of one long capsule.
  const Point<3> a(-0.2, 0, 0), joint(0.01, 0, 0), b(0.2, 0, 0);
  EXPECT_NEAR(length({{a, joint, kRadius}, {joint, b, kRadius}}), length({{a, b, kRadius}}),
              0.01 * length({{a, b, kRadius}}));
}

// A fingertip inside a larger cloth triangle: tests of the triangle's vertices cannot detect it.
TEST(UnitNumbers, FingertipInsideOneTriangle) {
  const Mesh cloth = sheet(2, 2, {-0.5, 0, -0.5}, {0, 0, 1}, {1, 0, 0});
  const double r = 0.02, d = 0.005;
  const Point<3> centre(0.31, d - r, 0.12);
  const Capsule tip{centre, centre - Point<3>(0, 0.1, 0), r};
  const ContactSample s = capsule_contact(cloth.view(), {&tip, 1});
  const double exact = 2 * kPi * std::sqrt(2 * r * d - d * d);
  EXPECT_NEAR(s.contour_length_m, exact, 0.02 * exact);
  EXPECT_NEAR(s.depth_max_m, d, 1e-12);
  const Mesh mesh = octasphere(16, r).moved(centre);
  EXPECT_NEAR(against(cloth, mesh).contour_length_m, exact, 0.01 * exact);
}

}  // namespace
}  // namespace clothbench::contact
