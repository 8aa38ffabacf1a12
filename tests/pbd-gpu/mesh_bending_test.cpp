// Bending of triangle meshes in xpbd: the matrix against beams, and what the kernel makes of it against double
// precision.
#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "mesh_scene.hpp"
#include "xpbd/mesh/matrices.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// A strip of 1 m x 0.25 m along x of cells x cells/4 squares, halved along drawn diagonals. Vertices inside are moved
/// by up to a share of a cell; the first two columns are as they are, and pinned.
Scene random_strip(int cells, double share, unsigned seed) {
  std::mt19937 random(seed);
  // Not std::uniform_real_distribution, which differs between libraries.
  const auto draw = [&] { return 2 * (static_cast<double>(random()) / 4294967296.0) - 1; };
  const int across = cells / 4;
  std::vector<Vec3> x;
  std::vector<std::array<std::uint32_t, 3>> t;
  std::vector<std::uint32_t> pins;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= across; ++j) {
      const double a = i > 1 && i < cells ? share * draw() : 0, b = i > 1 && j > 0 && j < across ? share * draw() : 0;
      if (i < 2) pins.push_back(static_cast<std::uint32_t>(x.size()));
      x.push_back({(i + a) / cells, 0.25 * (j + b) / across, 0});
    }
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < across; ++j) {
      const auto a = static_cast<std::uint32_t>(i * (across + 1) + j), b = a + static_cast<std::uint32_t>(across) + 1,
                 c = b + 1, d = a + 1;
      if (draw() > 0) {
        t.push_back({a, b, c});
        t.push_back({a, c, d});
      } else {
        t.push_back({a, b, d});
        t.push_back({b, c, d});
      }
    }
  return of_mesh(cloth_mesh(std::move(x), std::move(t), "strip"), std::move(pins));
}

Eigen::MatrixXd dense(const BendingMatrix& K) {
  const auto n = static_cast<Eigen::Index>(K.first.size() - 1);
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (std::uint32_t e = K.first[static_cast<std::size_t>(i)]; e < K.first[static_cast<std::size_t>(i) + 1]; ++e) {
      out(i, K.columns[e]) += K.stiffness[e];
      out(i, i) -= K.stiffness[e];
    }
  return out;
}

Scene bending(Scene s, double B) {
  s.material.bending_rigidity_N_m = B;
  s.needs.add(Feature::Bend);
  return s;
}

Eigen::VectorXd masses(const Scene& s) {
  const std::vector<double> m = vertex_masses(s);
  return Eigen::VectorXd::Map(m.data(), static_cast<Eigen::Index>(m.size()));
}

/// Mean deflection of the free end under its own weight, divided by the deflection of a beam, q L^4 / (8 B).
double tip_over_beam(int cells, double share, unsigned seed) {
  const double B = 2e-3;
  const Scene s = bending(random_strip(cells, share, seed), B);
  const Eigen::MatrixXd K = dense(bending_matrix(s));
  const Eigen::VectorXd load = masses(s) / s.cloth.areal_density_kg_per_m2;
  const auto clamped = static_cast<Eigen::Index>(s.pins.vertices.size()), free = K.rows() - clamped;
  const Eigen::VectorXd w = K.bottomRightCorner(free, free).ldlt().solve(load.tail(free));
  const double L = (cells - 1.0) / cells;
  return w.tail(cells / 4 + 1).mean() / (L * L * L * L / (8 * B));
}

TEST(MeshBendingMatrix, ACantileverIsThatOfABeamOnDrawnMeshes) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const double share = 0.06 * (seed - 1);  // up to 0.3 of a cell
    EXPECT_NEAR(tip_over_beam(8, share, seed), 1, 0.03) << "seed " << seed;
    EXPECT_NEAR(tip_over_beam(24, share, seed), 1, 0.005) << "seed " << seed;
  }
}

TEST(MeshBendingMatrix, ItsBoundIsAboveTheGreatestEigenvalueAndNotMuch) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Scene s = bending(random_strip(12, 0.12 * (seed - 1), seed), 1e-3);
    const BendingMatrix K = bending_matrix(s);
    const Eigen::VectorXd per = masses(s).cwiseSqrt().cwiseInverse();
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(per.asDiagonal() * dense(K) * per.asDiagonal()).eigenvalues();
    EXPECT_GE(K.max_per_s2, values[values.size() - 1]);
    EXPECT_LE(K.max_per_s2, 2 * values[values.size() - 1]);
  }
}

using MeshBending = Gpu;

/// Links as soft as nothing: what is left is M (x - y) = -h^2 K x, y the prediction.
TEST_F(MeshBending, OneSubstepIsTheImplicitStepInDoublePrecision) {
  for (const double B : {1e-5, 3e-3, 0.5}) {
    Scene s = bending(random_strip(12, 0.25, 4), B);
    s.material.membrane_stiffness_N_per_m = 1e-12;
    const double h = s.time.dt();
    const std::size_t n = s.cloth.vertex_count();
    const auto solver = make("xpbd", {{"substeps", 1}, {"time_order", 1}});
    solver->load(s);
    const std::vector<double> start = initial_positions(s);
    const auto clamped = static_cast<Eigen::Index>(s.pins.vertices.size()),
               free = static_cast<Eigen::Index>(n) - clamped;
    const Eigen::MatrixXd K = dense(bending_matrix(s));
    Eigen::MatrixXd A = h * h * K.bottomRightCorner(free, free);
    A.diagonal() += masses(s).tail(free);
    Eigen::VectorXd fallen = Eigen::VectorXd::Constant(free, -9.81 * h * h).cwiseProduct(masses(s).tail(free));
    const Eigen::VectorXd way = A.ldlt().solve(fallen);
    const ClothState end = after(*solver, s, 1);
    double most = 0;
    for (Eigen::Index v = 0; v < free; ++v) {
      const std::size_t at = 3 * static_cast<std::size_t>(v + clamped) + 1;
      most = std::max(most, std::abs(end.position[at] - start[at] - way[v]));
    }
    EXPECT_LE(most, 2e-3 * 9.81 * h * h) << "B " << B;
  }
}

TEST_F(MeshBending, ACantileverComesToRestAsABeam) {
  const int cells = 12;
  const double B = 0.2, density = 0.1, g = 1, L = (cells - 1.0) / cells;
  Scene s = with_damping(bending(random_strip(cells, 0.24, 2), B));
  s.cloth.areal_density_kg_per_m2 = density;
  s.material.damping_per_s = 12;
  s.gravity_m_per_s2 = {0, -g, 0};
  s.time = {30, 1.2};
  const auto solver = make("xpbd", {{"substeps", 8}});
  solver->load(s);
  const std::vector<double> start = initial_positions(s);
  const ClothState end = after(*solver, s, s.time.frames());
  double tip = 0;
  for (std::size_t k = start.size() - 3 * (cells / 4 + 1); k < start.size(); k += 3)
    tip += (start[k + 1] - end.position[k + 1]) / (cells / 4 + 1);
  EXPECT_NEAR(tip / (density * g * std::pow(L, 4) / (8 * B)), 1, 0.01);
}

}  // namespace
}  // namespace clothbench::pbd_gpu
