// Bending of triangle meshes in xpbd: the matrix against beams, and what the kernel makes of it against double
// precision.
#include <Eigen/Dense>
#include <cmath>

#include "random_strip.hpp"
#include "xpbd/mesh/bending.hpp"

namespace clothbench::pbd_gpu {
namespace {

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

/// The quadratic energy of hinges (Bergou et al. 2006, section 4), 3 B / (2 (A0 + A1)) times the square of four
/// weighted positions, of a flat strip.
Eigen::MatrixXd of_hinges(const ClothMesh& mesh, double B) {
  const auto n = static_cast<Eigen::Index>(mesh.vertices.size());
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
    int triangles = 0;
    for (const auto& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
        if (std::min(a, b) != mesh.edges[e].a || std::max(a, b) != mesh.edges[e].b) continue;
        const auto cotangent = [&](std::uint32_t at, std::uint32_t p, std::uint32_t q) {
          const Vec3 &x = mesh.vertices[at], &y = mesh.vertices[p], &z = mesh.vertices[q];
          const double u[2] = {y[0] - x[0], y[1] - x[1]}, v[2] = {z[0] - x[0], z[1] - x[1]};
          return (u[0] * v[0] + u[1] * v[1]) / std::abs(u[0] * v[1] - u[1] * v[0]);
        };
        const double at_a = cotangent(a, b, c), at_b = cotangent(b, c, a);
        row[a] += at_b;
        row[b] += at_a;
        row[c] -= at_a + at_b;
        ++triangles;
      }
    if (triangles == 2) K += 3 * B / mesh.areas_m2[e] * row * row.transpose();
  }
  return K;
}

/// Mean deflection of the free end under its own weight, divided by that of a beam: q L^4 / (8 B).
double tip_over_beam(int cells, double share, unsigned seed, bool hinges = false) {
  const double B = 2e-3;
  const Scene s = bending(random_strip(cells, share, seed), B);
  const Eigen::MatrixXd K = hinges ? of_hinges(*s.cloth.mesh, B) : dense(bending_matrix(s));
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

TEST_F(MeshBending, RepeatsBitForBitAndKeepsWhatItWeighs) {
  Scene s = bending(mesh_sheet(12), 1e-3);
  s.pins.vertices.clear();
  s.needs = s.needs - FeatureSet{Feature::Pins};
  s.cloth.spin_rad_per_s = {3, 0, 1};
  s.needs.add(Feature::Spin);
  const auto solver = make("xpbd");
  solver->load(s);
  const ClothState once = after(*solver, s, 10);
  solver->reset();
  EXPECT_EQ(after(*solver, s, 10).position, once.position);
  const std::vector<double> m = vertex_masses(s);
  double fall = 0, mass = 0;
  const std::vector<double> start = initial_positions(s);
  for (std::size_t v = 0; v < m.size(); ++v) {
    fall += m[v] * (once.position[3 * v + 1] - start[3 * v + 1]);
    mass += m[v];
  }
  const double free = xpbd_free_fall_m(s, complete_settings(xpbd_info(), {}), 10);
  EXPECT_NEAR(fall / mass, free, 1e-5 * std::abs(free));
}

}  // namespace
}  // namespace clothbench::pbd_gpu
