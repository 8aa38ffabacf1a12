#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "meshes.hpp"
#include "metrics/contact/contact_probe.hpp"
#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {
namespace {

/// Winding number from solid angles (van Oosterom & Strackee 1983, eq. 8), independent of ray crossings.
double winding_number(const Point<3>& p, const TriangleTree& mesh) {
  double sum = 0;
  for (const Simplex<3>& v : mesh.triangles()) {
    const Point<3> a = v[0] - p, b = v[1] - p, c = v[2] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

TEST(Inside, AgreesWithSolidAngles) {
  const Mesh ball = bumpy_ball(10, 0.2);
  // Two meshes that intersect: the winding number is 2 where they overlap.
  const Mesh both = together(ball, ball.moved({0.15, 0.02, 0.01}));
  const TriangleTree tree(both.view());
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-0.3, 0.4);
  int seen[3] = {};
  for (int i = 0; i < 2000; ++i) {
    const Point<3> p(unit(random), unit(random) - 0.05, unit(random) - 0.05);
    const double w = winding_number(p, tree);
    const int whole = static_cast<int>(std::lround(w));
    ASSERT_NEAR(w, whole, 1e-9);
    ASSERT_EQ(is_inside(p, tree), whole > 0);
    ++seen[whole];
  }
  EXPECT_GT(seen[0], 100);
  EXPECT_GT(seen[1], 100);
  EXPECT_GT(seen[2], 20);
}

TEST(Depth, IsDefinedOnlyWithAnInside) {
  const Mesh ball = octasphere(12, 0.1), cloth = sheet(32, 32, {-0.12, 0.085, -0.12}, {0, 0, 0.24}, {0.24, 0, 0});
  EXPECT_GT(against(cloth, ball).depth_max_m, 0);
  EXPECT_TRUE(std::isnan(against(cloth, ball, false).depth_max_m));
  EXPECT_EQ(against(cloth, ball, false).contour_length_m, against(cloth, ball).contour_length_m);
}

TEST(Distance, TreeFindsTheLeastOverAllTriangles) {
  const Mesh ball = bumpy_ball(9, 0.2);
  const TriangleTree tree(ball.view());
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-0.4, 0.4);
  for (int i = 0; i < 500; ++i) {
    const Point<3> p(unit(random), unit(random), unit(random));
    double least = INFINITY;
    for (const Simplex<3>& t : tree.triangles()) least = std::min(least, squared_distance(p, t));
    ASSERT_EQ(tree.distance(p), std::sqrt(least));
  }
}

TEST(Distance, ToATriangleAndToASliver) {
  const Simplex<3> v{Point<3>(0, 0, 0), Point<3>(4, 0, 0), Point<3>(0, 3, 0)};
  EXPECT_DOUBLE_EQ(squared_distance({1, 1, 2}, v), 4);
  EXPECT_DOUBLE_EQ(squared_distance({1, -2, 0}, v), 4);
  EXPECT_DOUBLE_EQ(squared_distance({-3, -4, 0}, v), 25);
  EXPECT_DOUBLE_EQ(squared_distance({7, -4, 0}, v), 25);
  EXPECT_DOUBLE_EQ(squared_distance({2 + 3, 1.5 + 4, 0}, v), 25);
  const Simplex<3> sliver{Point<3>(0, 0, 0), Point<3>(4, 0, 0), Point<3>(2, 0x1p-1000, 0)};
  EXPECT_DOUBLE_EQ(squared_distance({1, 0, 2}, sliver), 4);
  EXPECT_DOUBLE_EQ(squared_distance({7, 4, 0}, sliver), 25);
}

// Integers with up to 21 bits per factor: the determinant fits into 128 bits, but double rounds it.
template <int N>
__int128 integer_determinant(const std::array<std::array<long, N>, N>& m) {
  if constexpr (N == 1) {
    return m[0][0];
  } else {
    __int128 sum = 0;
    for (int c = 0; c < N; ++c) {
      std::array<std::array<long, N - 1>, N - 1> minor;
      for (int i = 1; i < N; ++i)
        for (int j = 0, k = 0; j < N; ++j)
          if (j != c) minor[i - 1][k++] = m[i][j];
      sum += (c % 2 ? -1 : 1) * static_cast<__int128>(m[0][c]) * integer_determinant<N - 1>(minor);
    }
    return sum;
  }
}

template <int N>
void nearly_singular() {
  std::mt19937 random(N);
  std::uniform_int_distribution<long> entry(-(1 << 20), 1 << 20), small(-1, 1);
  int zeros = 0, tiny = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::array<std::array<long, N>, N> m;
    for (auto& row : m)
      for (long& x : row) x = entry(random);
    // The last row is a linear combination of the others with small coefficients, plus or minus 1.
    for (int j = 0; j < N; ++j) {
      m[N - 1][j] = trial % 2 ? small(random) : 0;
      for (int i = 0; i < N - 1; ++i) m[N - 1][j] += (i + 1) * m[i][j];
    }
    std::array<Point<N>, N> head, tail;
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) {
        tail[i][j] = std::ldexp(static_cast<double>(entry(random)), -30);
        head[i][j] = tail[i][j] + std::ldexp(static_cast<double>(m[i][j]), -30);
      }
    const __int128 exact = integer_determinant<N>(m);
    ASSERT_EQ(sign_of_determinant<N>(head, tail), exact > 0 ? 1 : exact < 0 ? -1 : 0) << trial;
    exact == 0 ? ++zeros : ++tiny;
  }
  EXPECT_GE(zeros, 1000);
  EXPECT_GE(tiny, 500);
}

TEST(Predicates, SignsOfNearlySingularDeterminants) {
  nearly_singular<2>();
  nearly_singular<3>();
  nearly_singular<4>();
}

TEST(Predicates, ExtremeSizes) {
  for (const double size : {0x1p-300, 1.0, 0x1p+300}) {
    const Simplex<3> v{Point<3>(0, 0, 0), Point<3>(size, 0, 0), Point<3>(0, size, 0)};
    const Point<3> up(size / 4, size / 4, size), down(size / 4, size / 4, -size);
    EXPECT_EQ(crossing<3>(down, up, v), 1) << size;
    EXPECT_EQ(crossing<3>(up, down, v), -1) << size;
    EXPECT_FALSE(is_degenerate(v));
  }
}

// A path through any point of a flat fan crosses exactly one triangle, and exactly one half of the path crosses it.
TEST(Predicates, PathThroughAVertexMeetsOneTriangleOfTheFan) {
  const Point<3> hub(0, 0, 0);
  const Point<3> rim[6] = {{1, 0, 0}, {1, 1, 0}, {-1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}, {1, -1, 0}};
  for (const Point<3>& through : {hub, Point<3>(0.5, 0, 0), Point<3>(-0.25, 0.25, 0), Point<3>(0.125, -0.125, 0)})
    for (const Point<3>& way : {Point<3>(0, 0, 1), Point<3>(0.25, 0.5, 1), Point<3>(1, 0, 0.5)}) {
      int met = 0, to_plane = 0, from_plane = 0;
      for (int i = 0; i < 6; ++i) {
        const Simplex<3> v{hub, rim[i], rim[(i + 1) % 6]};
        met += crossing<3>(through - way, through + way, v);
        to_plane += crossing<3>(through - way, through, v);
        from_plane += crossing<3>(through, through + way, v);
      }
      EXPECT_EQ(met, 1);
      EXPECT_EQ(to_plane + from_plane, 1);
    }
}

TEST(Predicates, Degenerate) {
  const Point<3> a(0.1, 0.2, 0.3), b(0.4, 0.8, 0.9);
  EXPECT_TRUE(is_degenerate({a, a, b}));
  EXPECT_TRUE(is_degenerate({a, a, a}));
  EXPECT_TRUE(is_degenerate({Point<3>(0, 0, 0), Point<3>(1, 2, 3), Point<3>(3, 6, 9)}));
  EXPECT_FALSE(is_degenerate({Point<3>(0, 0, 0), Point<3>(1, 2, 3), Point<3>(3, 6, std::nextafter(9.0, 10))}));
  EXPECT_EQ(crossing<3>(Point<3>(0, 0, 1), Point<3>(1, 2, -3), {a, a, b}), 0);
}

// Self-contact: contour lengths are compared with values computed by hand, and pairs with a brute-force search.

TEST(SelfContour, FlatRolledAndFoldedClothCrossesNowhere) {
  const Mesh flat = sheet(12, 12, Point<3>(0, 0, 0), Point<3>(1, 0, 0), Point<3>(0, 0, 1));
  const Mesh rolled = flat.mapped([](const Point<3>& p) {
    const double turn = 15 * p[0], r = 0.05 + 0.02 * p[0];
    return Point<3>(r * std::cos(turn), r * std::sin(turn), p[2]);
  });
  const Mesh folded =
      flat.mapped([](const Point<3>& p) { return Point<3>(std::abs(p[0] - 0.5), 0.01 * (p[0] - 0.5), p[2]); });
  for (const Mesh* m : {&flat, &rolled, &folded}) {
    EXPECT_EQ(self_contour(m->view()).pairs, 0);
    EXPECT_EQ(self_contour(m->view()).length_m, 0);
  }
  // Folded flat, layer on layer: the layers touch but do not cross.
  const Mesh pressed = flat.mapped([](const Point<3>& p) { return Point<3>(std::abs(p[0] - 0.5), 0, p[2]); });
  EXPECT_GT(self_contour(pressed.view()).pairs, 100);
  EXPECT_EQ(self_contour(pressed.view()).length_m, 0);
}

TEST(SelfContour, FindsThePairsThatLookingAtAllFinds) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-0.3, 0.3);
  const Mesh crumpled =
      sheet(7, 6, Point<3>(0, 0, 0), Point<3>(1, 0, 0), Point<3>(0, 0, 1)).mapped([&](const Point<3>& p) {
        return Point<3>(p + Point<3>(any(random), any(random), any(random)));
      });
  Contour all;
  for (std::size_t a = 0; a < crumpled.triangles.size(); ++a)
    for (std::size_t b = a + 1; b < crumpled.triangles.size(); ++b) {
      const auto &first = crumpled.triangles[a], &second = crumpled.triangles[b];
      if (std::find_first_of(first.begin(), first.end(), second.begin(), second.end()) != first.end()) continue;
      const Mesh one{crumpled.positions, {first}}, other{crumpled.positions, {second}};
      const Contour c = contour(one.view(), TriangleTree(other.view()));
      all.pairs += c.pairs;
      all.length_m += c.length_m;
    }
  const Contour c = self_contour(crumpled.view());
  EXPECT_GT(all.pairs, 50);
  EXPECT_EQ(c.pairs, all.pairs);
  EXPECT_NEAR(c.length_m, all.length_m, 1e-9);
}

}  // namespace
}  // namespace clothbench::contact
