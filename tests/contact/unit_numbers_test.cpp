// A flat sheet pushed by d into a sphere of radius R: circle of radius a = sqrt(2Rd - d^2).
#include <gtest/gtest.h>

#include "meshes.hpp"
#include "metrics/contact/contact_probe.hpp"

namespace clothbench::contact {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 0.1;

struct Exact {
  double d, contour, area, mean, p99;
};

Exact exact(double d) {
  const double a2 = 2 * kRadius * d - d * d, h = kRadius - d;
  // Mean over the disc of R - sqrt(h^2 + r^2); 1 % of its area is within 0.1 a of the middle.
  return {d, 2 * kPi * std::sqrt(a2), kPi * a2, kRadius - 2.0 / 3 * (std::pow(kRadius, 3) - h * h * h) / a2,
          kRadius - std::sqrt(h * h + 0.01 * a2)};
}

TEST(UnitNumbers, ClosedFormsGiveThePublishedDigits) {
  const double table[3][4] = {{0.005, 0.1961924, 0.00306305, 2.47863e-3},
                              {0.01, 0.2738777, 0.00596903, 4.91228e-3},
                              {0.02, 0.3769911, 0.01130973, 9.62963e-3}};
  for (const auto& row : table) {
    const Exact e = exact(row[0]);
    EXPECT_NEAR(e.contour, row[1], 6e-8);
    EXPECT_NEAR(e.area, row[2], 6e-9);
    EXPECT_NEAR(e.mean, row[3], 6e-9);
  }
}

/// A horizontal sheet d below the sphere's top, a vertex under the top, cells not aligned with the sphere's triangles.
Mesh lowered_sheet(int cells, double d) {
  const double c = std::cos(0.3), s = std::sin(0.3), side = 0.24;
  const Point<3> u(side * c, 0, -side * s), v(side * s, 0, side * c);
  return sheet(cells, cells, Point<3>(0, kRadius - d, 0) - 0.5 * (u + v), v, u);
}

/// Sphere turned so that the plane cuts it in no special way, but with a vertex on top, where the depth is greatest.
Mesh ball(int n) {
  const Mesh plain = octasphere(n, kRadius);
  const Point<3> top = plain.view().vertex(plain.triangles[n][0]).normalized();
  const Eigen::Matrix3d turn = Eigen::Quaterniond::FromTwoVectors(top, Point<3>::UnitY()).toRotationMatrix();
  return plain.mapped([&](const Point<3>& p) { return Point<3>(turn * p); });
}

ContactSample mesh_sample(int level, double d) {
  const Mesh cloth = lowered_sheet(24 << level, d), object = ball(20 << level);
  return ContactProbe(cloth.view(), object.view()).probe(cloth.positions);
}

/// Three levels, each half as coarse: close to the exact value, and the observed order 2 +- 0.3.
TEST(UnitNumbers, SphereMesh) {
  for (const double d : {0.005, 0.01, 0.02}) {
    const Exact e = exact(d);
    const ContactSample s[3] = {mesh_sample(0, d), mesh_sample(1, d), mesh_sample(2, d)};
    const auto check = [&](const char* name, double ContactSample::*field, double truth, double tolerance) {
      const double coarse = std::abs(s[0].*field - truth), fine = std::abs(s[2].*field - truth);
      const double order = std::log2(coarse / fine) / 2;
      printf("  d = %-5g %-8s %.9g, exact %.9g, error %.2e, order %.2f\n", d, name, s[2].*field, truth, fine / truth,
             order);
      EXPECT_LE(fine, tolerance * truth) << name << " at d = " << d;
      EXPECT_LE(std::abs(order - 2), 0.3) << name << " at d = " << d << ": " << s[0].*field << ", " << s[1].*field
                                          << ", " << s[2].*field << ", exact " << truth;
    };
    check("contour", &ContactSample::contour_length_m, e.contour, 2e-3);
    check("area", &ContactSample::area_m2, e.area, 4e-3);
    check("mean", &ContactSample::depth_mean_m, e.mean, 4e-3);
    EXPECT_LE(std::abs(s[2].depth_max_m - d), 1e-4 * kRadius) << d;
    EXPECT_LE(std::abs(s[2].depth_p99_m - e.p99), 0.01 * d) << d;
  }
}

// A capsule's section by each triangle has an area and a border in closed form; the mean is of a rule of eight points.
TEST(UnitNumbers, AnalyticSphere) {
  for (const double d : {0.005, 0.01, 0.02}) {
    const Exact e = exact(d);
    const Mesh cloth = lowered_sheet(6, d);
    const Capsule shape = sphere(Point<3>::Zero(), kRadius);
    const ContactSample s = ContactProbe(cloth.view(), {&shape, 1}).probe(cloth.positions);
    EXPECT_NEAR(s.contour_length_m, e.contour, 1e-9 * e.contour) << d;
    EXPECT_NEAR(s.area_m2, e.area, 1e-9 * e.area) << d;
    EXPECT_NEAR(s.depth_mean_m, e.mean, 1e-3 * e.mean) << d;
    EXPECT_NEAR(s.depth_p99_m, e.p99, 1e-9) << d;
    EXPECT_NEAR(s.depth_max_m, d, 1e-12) << d;
  }
}

TEST(UnitNumbers, ShallowContours) {
  for (const double share : {1e-5, 1e-4, 1e-3, 3e-3, 0.01}) {
    const double d = share * kRadius, a = std::sqrt(2 * kRadius * d - d * d), length = 0.3;
    const Mesh cloth = lowered_sheet(6, d);
    const Capsule ball = sphere(Point<3>::Zero(), kRadius);
    const ContactSample in_ball = ContactProbe(cloth.view(), {&ball, 1}).probe(cloth.positions);
    EXPECT_NEAR(in_ball.contour_length_m, 2 * kPi * a, 1e-9 * a);
    EXPECT_NEAR(in_ball.depth_max_m, d, 1e-12);
    // Across the top of a capsule along x: a stadium. Upright on its end: a circle.
    const Mesh wide = sheet(16, 16, {-0.35, kRadius - d, -0.25}, {0, 0, 0.5}, {0.7, 0, 0});
    const Capsule lying{{-length / 2, 0, 0}, {length / 2, 0, 0}, kRadius}, upright{{0, -length, 0}, {0, 0, 0}, kRadius};
    const double stadium = 2 * kPi * a + 2 * length;
    EXPECT_NEAR(ContactProbe(wide.view(), {&lying, 1}).probe(wide.positions).contour_length_m, stadium, 1e-9) << share;
    EXPECT_NEAR(ContactProbe(cloth.view(), {&upright, 1}).probe(cloth.positions).contour_length_m, 2 * kPi * a,
                1e-9 * a)
        << share;
  }
}

// A capsule lying along x, cut by a plane parallel to it: a stadium of two half circles and two lines.
TEST(UnitNumbers, AnalyticCapsule) {
  const double d = 0.02, length = 0.3, a = std::sqrt(2 * kRadius * d - d * d);
  const Mesh cloth = sheet(16, 16, {-0.35, kRadius - d, -0.25}, {0, 0, 0.5}, {0.7, 0, 0});
  const Capsule shape{{-length / 2, 0, 0}, {length / 2, 0, 0}, kRadius};
  const ContactSample s = ContactProbe(cloth.view(), {&shape, 1}).probe(cloth.positions);
  EXPECT_NEAR(s.contour_length_m, 2 * kPi * a + 2 * length, 1e-9);
  EXPECT_NEAR(s.area_m2, kPi * a * a + 2 * a * length, 1e-10);
  EXPECT_NEAR(s.depth_max_m, d, 1e-12);
  EXPECT_NEAR(s.area_fraction, s.area_m2 / 0.35, 1e-12);
}

// Two spheres far enough apart count as two, and a duplicate changes nothing but the name.
TEST(UnitNumbers, UnionOfSpheres) {
  const Mesh cloth = sheet(40, 20, {-0.5, 0.09, -0.25}, {0, 0, 0.5}, {1, 0, 0});
  const Capsule left = sphere({-0.22, 0, 0}, kRadius), right = sphere({0.21, 0, 0}, kRadius);
  const auto probe = [&](std::vector<Capsule> shapes) {
    return ContactProbe(cloth.view(), shapes).probe(cloth.positions);
  };
  const ContactSample one = probe({left}), other = probe({right}), both = probe({left, right}),
                      thrice = probe({left, right, left});
  EXPECT_NEAR(both.contour_length_m, one.contour_length_m + other.contour_length_m, 1e-12);
  EXPECT_NEAR(both.area_m2, one.area_m2 + other.area_m2, 1e-12);
  EXPECT_EQ(both.pairs, one.pairs + other.pairs);
  EXPECT_EQ(thrice.contour_length_m, both.contour_length_m);
  EXPECT_EQ(thrice.area_m2, both.area_m2);
}

// Smaller than a cloth triangle, and between its vertices: what vertices alone can't see.
TEST(UnitNumbers, FingertipInsideOneTriangle) {
  const Mesh cloth = sheet(2, 2, {-0.5, 0, -0.5}, {0, 0, 1}, {1, 0, 0});
  const double r = 0.02, d = 0.005;
  const Point<3> centre(0.31, d - r, 0.12);
  const Capsule tip{centre, centre - Point<3>(0, 0.1, 0), r};
  const ContactSample s = ContactProbe(cloth.view(), {&tip, 1}).probe(cloth.positions);
  EXPECT_EQ(s.depth_vertex_max_m, 0);
  EXPECT_EQ(s.tunnelled_fraction, 0);
  EXPECT_EQ(s.pairs, 1);
  EXPECT_NEAR(s.contour_length_m, 2 * kPi * std::sqrt(2 * r * d - d * d), 1e-12);
  EXPECT_NEAR(s.depth_max_m, d, 1e-12);
  const Mesh mesh = octasphere(16, r).moved(centre);
  const ContactSample m = ContactProbe(cloth.view(), mesh.view()).probe(cloth.positions);
  EXPECT_NEAR(m.contour_length_m, s.contour_length_m, 0.01 * s.contour_length_m);
}

}  // namespace
}  // namespace clothbench::contact
