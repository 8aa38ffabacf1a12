#include "metrics/contact/predicates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace clothbench::contact {
namespace {

// Integers that need up to 21 bits a factor: the determinant fits 128-bit integers, and double rounding loses it.
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
    // The last row is a small combination of the others, give or take 1.
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

// One in the plane, one beyond it, in every place of a fan: exactly one triangle takes a path through the hub.
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

}  // namespace
}  // namespace clothbench::contact
