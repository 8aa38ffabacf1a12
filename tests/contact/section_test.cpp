// What a triangle has of a union of capsules, against identities that hold for any of them, drawn by a seed.
#include <gtest/gtest.h>

#include <random>

#include "meshes.hpp"
#include "metrics/contact/shapes.hpp"

namespace clothbench::contact {
namespace {

class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  double number(double low, double high) { return low + (high - low) * static_cast<double>(engine_()) / 4294967296.0; }
  Point<3> point(double reach) { return {number(-reach, reach), number(-reach, reach), number(-reach, reach)}; }
  Simplex<3> triangle() { return {point(0.05), point(0.05), point(0.05)}; }
  /// A chain, as a finger has: neighbours share a joint, with one radius or two.
  std::vector<Capsule> chain(int count) {
    std::vector<Capsule> out;
    Point<3> from = point(0.05);
    double radius = number(0.005, 0.03);
    for (int k = 0; k < count; ++k) {
      const Point<3> to = from + point(0.05);
      out.push_back({from, to, radius});
      from = to;
      if (number(0, 1) < 0.5) radius = number(0.005, 0.03);
    }
    return out;
  }

 private:
  std::mt19937 engine_;
};

std::array<Simplex<3>, 4> quarters(const Simplex<3>& v) {
  const Point<3> a = 0.5 * (v[0] + v[1]), b = 0.5 * (v[1] + v[2]), c = 0.5 * (v[2] + v[0]);
  return {{{v[0], a, c}, {a, v[1], b}, {c, b, v[2]}, {a, b, c}}};
}

/// Share of a triangle's points in capsules by counting the middles of n^2 equal triangles.
double counted_share(const Simplex<3>& v, const std::vector<Capsule>& shapes, int n) {
  long inside = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n - i; ++j)
      for (int half = 0; half < (j + 1 < n - i ? 2 : 1); ++half) {
        const double s = (i + (1 + half) / 3.0) / n, t = (j + (1 + half) / 3.0) / n;
        const Point<3> p = v[0] + s * (v[1] - v[0]) + t * (v[2] - v[0]);
        inside +=
            std::any_of(shapes.begin(), shapes.end(), [&](const Capsule& c) { return signed_distance(p, c) < 0; });
      }
  return static_cast<double>(inside) / n / n;
}

TEST(Section, PartsOfATriangleAddUp) {
  Draw draw(1);
  int cut = 0;
  for (int k = 0; k < 2000; ++k) {
    const Simplex<3> whole = draw.triangle();
    const std::vector<Capsule> shapes = draw.chain(1 + k % 4);
    const TriangleSection section(whole, shapes);
    const double less = k % 3 == 0 ? 0 : draw.number(0, 1) * section.depth_m();
    double border = 0, inside = 0, depth = 0;
    for (const Simplex<3>& part : quarters(whole)) {
      const TriangleSection one(part, shapes);
      border += one.border().length_m;
      inside += one.area_deeper_m2(less);
      depth = std::max(depth, one.depth_m());
    }
    EXPECT_NEAR(section.border().length_m, border, 1e-9) << k;
    EXPECT_NEAR(section.area_deeper_m2(less), inside, 1e-11) << k;
    EXPECT_NEAR(section.depth_m(), depth, 1e-12) << k;
    cut += border > 0;
  }
  EXPECT_GT(cut, 500);
}

TEST(Section, ACapsuleInTwoPartsIsTheSame) {
  Draw draw(2);
  for (int k = 0; k < 500; ++k) {
    const Simplex<3> triangle = draw.triangle();
    const Capsule whole = draw.chain(1)[0];
    const Point<3> between = whole.a + draw.number(0.1, 0.9) * (whole.b - whole.a);
    const TriangleSection one(triangle, std::vector{whole}),
        two(triangle, std::vector<Capsule>{{whole.a, between, whole.radius_m}, {between, whole.b, whole.radius_m}});
    EXPECT_NEAR(one.border().length_m, two.border().length_m, 1e-9) << k;
    EXPECT_NEAR(one.area_deeper_m2(0), two.area_deeper_m2(0), 1e-11) << k;
  }
}

TEST(Section, AreaIsThatOfCountedPoints) {
  Draw draw(3);
  for (int k = 0; k < 40; ++k) {
    const Simplex<3> triangle = draw.triangle();
    const std::vector<Capsule> shapes = draw.chain(3);
    const double share = TriangleSection(triangle, shapes).area_deeper_m2(0) / area(triangle);
    EXPECT_NEAR(share, counted_share(triangle, shapes, 300), 4.0 / 300) << k;
  }
}

// The area that is deeper than d falls by the border's length times the sine of the angle between plane and surface, a
// sphere's r / a: so the border is the area's derivative.
TEST(Section, BorderIsTheDerivativeOfTheArea) {
  Draw draw(4);
  int met = 0;
  for (int k = 0; k < 200; ++k) {
    const Simplex<3> v = draw.triangle();
    const Capsule ball = sphere(draw.point(0.02), draw.number(0.02, 0.05));
    const Point<3> normal = (v[1] - v[0]).cross(v[2] - v[0]).normalized();
    const double height = normal.dot(ball.a - v[0]), squared = ball.radius_m * ball.radius_m - height * height;
    if (!(squared > 1e-5)) continue;
    const double h = 1e-6, ratio = ball.radius_m / std::sqrt(squared);
    const auto with_radius = [&](double r) {
      return TriangleSection(v, std::vector{sphere(ball.a, r)}).area_deeper_m2(0);
    };
    const double slope = (with_radius(ball.radius_m + h) - with_radius(ball.radius_m - h)) / (2 * h);
    const double border = TriangleSection(v, std::vector{ball}).border().length_m;
    EXPECT_NEAR(slope, ratio * border, 1e-4) << k;
    met += border > 0;
  }
  EXPECT_GT(met, 50);
}

// Far from its ends a capsule that stands askew has an ellipse.
TEST(Section, ObliqueEllipse) {
  for (const double degrees : {1.0, 5.0, 30.0, 60.0, 89.0, 90.0}) {
    const double angle = degrees * std::numbers::pi / 180, r = 0.01, major = r / std::sin(angle);
    const Point<3> along(std::cos(angle), std::sin(angle), 0);
    const Simplex<3> plane{{{-9, 0, -5}, {0, 0, 9}, {9, 0, -5}}};
    const TriangleSection s(plane, std::vector<Capsule>{{-2 * along, 2 * along, r}});
    const double e = std::sqrt(1 - r * r / (major * major));
    EXPECT_NEAR(s.border().length_m, 4 * major * std::comp_ellint_2(e), 1e-9) << degrees;
    EXPECT_NEAR(s.area_deeper_m2(0), std::numbers::pi * r * major, 1e-11) << degrees;
  }
}

// Nearly parallel to the plane, on both sides of where two lines stand for the ellipse.
TEST(Section, NearlyParallel) {
  const double r = 0.01, length = 0.2, h = 0.004, half = std::sqrt(r * r - h * h);
  const Simplex<3> plane{{{-0.5, 0, -0.3}, {0, 0, 0.5}, {0.5, 0, -0.3}}};
  for (const double rise : {0.0, 1e-10, 1.9e-9, 2.1e-9, 1e-8, 1e-7}) {
    const TriangleSection s(plane,
                            std::vector<Capsule>{{{-length / 2, h - rise / 2, 0}, {length / 2, h + rise / 2, 0}, r}});
    EXPECT_NEAR(s.border().length_m, 2 * length + 2 * std::numbers::pi * half, 2e-9) << rise;
    EXPECT_NEAR(s.area_deeper_m2(0), 2 * length * half + std::numbers::pi * half * half, 1e-9) << rise;
  }
}

// The rule of eight points of shapes_contact against 400 points, triangle by triangle.
TEST(Section, MeanDepthIsNearItsIntegral) {
  Draw draw(5);
  double worst = 0, squares = 0;
  int met = 0;
  for (int k = 0; k < 400; ++k) {
    const Simplex<3> v = draw.triangle();
    const std::vector<Capsule> shapes = draw.chain(1 + k % 3);
    const TriangleSection section(v, shapes);
    const double area = section.area_deeper_m2(0);
    if (!(area > 1e-6)) continue;
    constexpr int kSteps = 400;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) sum += section.area_deeper_m2((i + 0.5) / kSteps * section.depth_m());
    const double mean = sum * section.depth_m() / kSteps / area;
    Mesh mesh;
    mesh.triangles.push_back({mesh.add(v[0]), mesh.add(v[1]), mesh.add(v[2])});
    const double error = std::abs(shapes_contact(mesh.view(), shapes).depth.mean_m / mean - 1);
    worst = std::max(worst, error);
    squares += error * error;
    ++met;
  }
  const double rms = std::sqrt(squares / met);
  std::printf("  %d triangles, error of the mean depth: greatest %.1e, RMS %.1e\n", met, worst, rms);
  EXPECT_GT(met, 50);
  EXPECT_LT(worst, 0.03);
  EXPECT_LT(rms, 3e-3);
}

TEST(Section, NoAreaIsNoSection) {
  const std::vector<Capsule> ball{sphere({0, 0, 0}, 0.1)};
  const TriangleSection line({{{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}}}, ball);
  EXPECT_EQ(line.border().length_m, 0);
  EXPECT_EQ(line.area_deeper_m2(0), 0);
  EXPECT_EQ(line.depth_m(), 0.1);
}

}  // namespace
}  // namespace clothbench::contact
