#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "clothbench/error.hpp"
#include "truth/reference_case.hpp"

namespace clothbench::truth {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Mesh {
  std::vector<double> rest;
  std::vector<std::uint32_t> triangles;
  template <class F>
  std::vector<double> values(F f) const {
    std::vector<double> out;
    for (std::size_t v = 0; v < rest.size(); v += 2)
      for (const double x : f(rest[v], rest[v + 1])) out.push_back(x);
    return out;
  }
};

/// n x m cells over w x h, with inner vertices moved by up to a third of a cell, and random diagonals and windings.
Mesh mesh(int n, int m, double w, double h, double shake = 0) {
  Mesh out;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> by(-shake, shake);
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) {
      const double du = i == 0 || i == n ? 0 : by(random), dv = j == 0 || j == m ? 0 : by(random);
      out.rest.push_back(w * (i + du) / n);
      out.rest.push_back(h * (j + dv) / m);
    }
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (n + 1) + i), b = a + 1, c = a + static_cast<std::uint32_t>(n) + 1,
                 d = c + 1;
      if (random() % 2)
        out.triangles.insert(out.triangles.end(), {a, b, d, a, c, d});
      else
        out.triangles.insert(out.triangles.end(), {a, b, c, d, c, b});
    }
  return out;
}

TEST(Lattice, AreasCoverTheRectangle) {
  const MaterialLattice lattice(0.3, 1.2);
  EXPECT_EQ(lattice.size(), 33u * 33u);
  EXPECT_NEAR(std::accumulate(lattice.areas_m2.begin(), lattice.areas_m2.end(), 0.0), 0.36, 1e-13);
  EXPECT_EQ(lattice.longer_side_m, 1.2);
  EXPECT_EQ(lattice.points_m.back(), (std::array<double, 2>{0.3, 1.2}));
  EXPECT_NEAR(lattice.areas_m2[0] * 4, lattice.areas_m2[34], 1e-18);
  EXPECT_NEAR(lattice.areas_m2[5] * 2, lattice.areas_m2[34], 1e-18);
}

TEST(Lattice, SamplesLinearFieldsExactlyOnAnyMesh) {
  const MaterialLattice lattice(0.3, 1.2);
  const auto field = [](double u, double v) { return std::array<double, 3>{2 * u - v + 1, 3 * v, u + v}; };
  for (const int n : {1, 7, 8, 31, 32, 63, 128})
    for (const double shake : {0.0, 0.33}) {
      const Mesh m = mesh(n, n, 0.3, 1.2, shake);
      const auto values = LatticeSampler(lattice, m.rest, m.triangles).sample(m.values(field));
      for (std::size_t s = 0; s < lattice.size(); ++s) {
        const auto exact = field(lattice.points_m[s][0], lattice.points_m[s][1]);
        for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(values[3 * s + k], exact[k], 1e-12) << n << ' ' << s;
      }
    }
}

TEST(Lattice, SamplingErrorIsOfOrderTwo) {
  const MaterialLattice lattice(1, 1);
  const auto field = [](double u, double v) {
    return std::array<double, 3>{std::sin(3 * u + v), u * v, std::cos(4 * v)};
  };
  std::vector<double> exact;
  for (const auto& p : lattice.points_m)
    for (const double x : field(p[0], p[1])) exact.push_back(x);
  const auto error = [&](int n) {
    const Mesh m = mesh(n, n, 1, 1, 0.3);
    return lattice_rms_error(lattice, LatticeSampler(lattice, m.rest, m.triangles).sample(m.values(field)), exact, 1);
  };
  EXPECT_NEAR(std::log2(error(12) / error(48)) / 2, 2, 0.2);
}

TEST(Lattice, RefusesMeshesThatLeaveHoles) {
  const MaterialLattice lattice(1, 1);
  Mesh m = mesh(8, 8, 1, 1);
  EXPECT_THROW(LatticeSampler(lattice, m.rest, std::span(m.triangles).first(m.triangles.size() - 3)), Error);
  EXPECT_THROW(LatticeSampler(lattice, mesh(8, 8, 0.99, 1).rest, m.triangles), Error);
  m.rest[40] = kNan;
  EXPECT_THROW(LatticeSampler(lattice, m.rest, m.triangles), Error);
}

TEST(Norms, LatticeErrors) {
  const MaterialLattice lattice(1, 2);
  std::vector<double> truth(3 * lattice.size(), 1.0), moved = truth, one = truth;
  for (std::size_t i = 0; i < moved.size(); i += 3) {
    moved[i] += 0.3;
    moved[i + 2] -= 0.4;
  }
  EXPECT_NEAR(lattice_rms_error(lattice, moved, truth, 2), 0.25, 1e-14);
  one[3 * 34] += 1;  // an inner point, which stands for one cell of 1024
  EXPECT_NEAR(lattice_rms_error(lattice, one, truth, 1), 1.0 / 32, 1e-14);
  for (const double bad : {kNan, std::numeric_limits<double>::infinity()}) {
    one[0] = bad;
    EXPECT_TRUE(std::isnan(lattice_rms_error(lattice, one, truth, 1)));
  }
}

TEST(Norms, OverTime) {
  const std::vector<double> times{0, 1, 3}, errors{0, 2, 2}, bad{0, kNan, 1};
  EXPECT_NEAR(time_rms(times, errors), std::sqrt((2 + 8) / 3.0), 1e-15);
  EXPECT_TRUE(std::isnan(time_rms(times, bad)));
  EXPECT_NEAR(quantity_error(1.1, 1, 0.5), 0.2, 1e-14);
  EXPECT_TRUE(std::isnan(quantity_error(kNan, 1, 0.5)));
}

TEST(Norms, Stretch) {
  std::vector<double> strains(200, 0.01), truth(200, 0.01);
  strains[3] = 0.11;
  strains[4] = 0.06;
  strains[5] = 0.02;
  strains[6] = -0.09;
  const auto [p99, greatest] = stretch_error(strains, truth);
  EXPECT_NEAR(greatest, 0.1, 1e-15);
  EXPECT_NEAR(p99, 0.01, 1e-15);  // the 198th of 200
  strains[7] = kNan;
  EXPECT_TRUE(std::isnan(stretch_error(strains, truth)[0]));
}

}  // namespace
}  // namespace clothbench::truth
