// Bending of triangle meshes (Morley's element) against beams, on meshes drawn by a seed.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "clothbench/solver.hpp"
#include "reference/mesh_energy.hpp"
#include "scenario/cloth_mesh.hpp"
#include "scenario/load.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

constexpr double kLength_m = 1, kWidth_m = 0.25;

/// An OBJ of a strip along x: inner vertices moved by up to a share of a cell, diagonals drawn. The first two columns,
/// which are the clamp, are as they are.
std::string strip(int cells, double share, unsigned seed) {
  std::mt19937 random(seed);
  const auto draw = [&] { return std::uniform_real_distribution<double>(-share, share)(random); };
  const int across = cells / 4;
  std::string out;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= across; ++j) {
      const bool free = i > 1 && i < cells;
      const double x = kLength_m * (i + (free ? draw() : 0)) / cells;
      const double y = kWidth_m * (j + (i > 1 && j > 0 && j < across ? draw() : 0)) / across;
      out += "v " + std::to_string(x) + " " + std::to_string(y) + " 0\n";
    }
  const auto face = [&](int a, int b, int c) {
    for (const int v : {a, b, c}) out += (v == a ? "f " : " ") + std::to_string(v + 1);
    out += "\n";
  };
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < across; ++j) {
      const int a = i * (across + 1) + j, b = a + across + 1, c = b + 1, d = a + 1;
      if (draw() > 0) {
        face(a, b, c);
        face(a, c, d);
      } else {
        face(a, b, d);
        face(b, c, d);
      }
    }
  return out;
}

/// Mean deflection of the free end under a uniform load, divided by a beam's: q L^4 / (8 B).
double tip_over_beam(int cells, double share, unsigned seed) {
  const ClothMesh mesh = parse_obj(strip(cells, share, seed), "strip.obj");
  const int across = cells / 4, clamped = 2 * (across + 1), all = static_cast<int>(mesh.vertices.size());
  std::vector<std::uint32_t> pinned(static_cast<std::size_t>(clamped));
  for (int v = 0; v < clamped; ++v) pinned[static_cast<std::size_t>(v)] = static_cast<std::uint32_t>(v);
  const double B = 2e-3, q = 0.3;
  const Eigen::MatrixXd K = reference::bending_matrix(mesh, B, pinned);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(all);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto p = rest_corners(mesh, t);
    const double area = 0.5 * ((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]));
    for (const std::uint32_t v : mesh.triangles[t]) load[v] += q * area / 3;
  }
  const int free = all - clamped;
  const Eigen::VectorXd w = K.bottomRightCorner(free, free).ldlt().solve(load.tail(free));
  const double L = kLength_m * (cells - 1) / cells;
  return w.tail(across + 1).mean() / (q * L * L * L * L / (8 * B));
}

TEST(MeshBending, ACantileverIsThatOfABeamOnDrawnMeshesWithOrderTwo) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const double share = 0.06 * seed;  // up to 0.36 of a cell
    const double coarse = std::abs(tip_over_beam(8, share, seed) - 1),
                 fine = std::abs(tip_over_beam(24, share, seed) - 1);
    EXPECT_LE(fine, 0.005) << "seed " << seed;
    EXPECT_GE(std::log(coarse / fine) / std::log(3), 1.8) << "seed " << seed;
  }
}

TEST(MeshBending, RigidMotionsAndPlanesCostNothing) {
  const ClothMesh mesh = parse_obj(strip(12, 0.3, 7), "strip.obj");
  const Eigen::MatrixXd K = reference::bending_matrix(mesh, 1, {});
  EXPECT_LE((K - K.transpose()).cwiseAbs().maxCoeff(), 1e-12 * K.cwiseAbs().maxCoeff());
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::VectorXd plane(K.rows());
    for (Eigen::Index v = 0; v < K.rows(); ++v)
      plane[v] = axis == 2 ? 1 : mesh.vertices[static_cast<std::size_t>(v)][static_cast<std::size_t>(axis)];
    EXPECT_LE((K * plane).cwiseAbs().maxCoeff(), 1e-9 * K.cwiseAbs().maxCoeff());
  }
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
  EXPECT_GE(values[0], -1e-9 * values[K.rows() - 1]);
  EXPECT_GE(values[3], 1e-6 * values[K.rows() - 1]) << "no other motion is free: there are no spurious modes";
}

/// Runs the solver: damped to rest under a small load.
TEST(MeshBending, TheReferenceSolverComesToRestAsTheBeam) {
  const ScratchFolder folder;
  const int cells = 12;
  folder.file("strip.obj", strip(cells, 0.25, 3));
  const double B = 0.02, density = 0.1, g = 0.1;
  nlohmann::json j = {
      {"name", "strip"},
      {"why", "a cantilever of triangles"},
      {"cloth",
       {{"mesh", {{"file", "strip.obj"}}},
        {"areal_density_kg_per_m2", density},
        {"sides", "single"},
        {"pose", nlohmann::json::object()}}},
      {"material", {{"membrane_stiffness_N_per_m", 1e3}, {"bending_rigidity_N_m", B}, {"damping_per_s", 6}}},
      {"gravity_m_per_s2", {0, -g, 0}},
      {"time", {{"frame_rate_hz", 10}, {"duration_s", 6}}}};
  j["pins"] = nlohmann::json::array();
  for (const double x : {0.0, kLength_m / cells})
    for (int k = 0; k <= cells / 4; ++k) j["pins"].push_back({{"nearest_m", {{x, kWidth_m * k / (cells / 4), 0}}}});
  const Scene scene = scene_from_json(j, folder.path() + "/scene.json");
  ASSERT_EQ(scene.pins.vertices.size(), static_cast<std::size_t>(2 * (cells / 4 + 1)));
  const SolverEntry& e = find_solver("reference");
  auto solver = e.make(complete_settings(e.info, {{"substeps", 2}}), {});
  solver->load(scene);
  for (int f = 0; f < scene.time.frames(); ++f)
    ASSERT_EQ(solver->step({f, (f + 1) * scene.time.dt(), scene.time.dt(), nullptr}), StepStatus::Ok);
  ClothState state;
  solver->read_state(state);
  const std::vector<double> start = initial_positions(scene);
  double tip = 0;
  for (std::size_t k = start.size() - 3 * (cells / 4 + 1); k < start.size(); k += 3)
    tip += (start[k + 1] - state.position[k + 1]) / (cells / 4 + 1);
  const double L = kLength_m * (cells - 1) / cells;
  EXPECT_NEAR(tip / (density * g * std::pow(L, 4) / (8 * B)), 1, 0.03);
}

// Triangles of constant strain against the energy of an isotropic sheet.

/// Energy over area under the strain (xx, yy, xy): plane stress, Poisson's ratio 1/3.
double of_sheet(double Y, const Eigen::Vector3d& e) {
  const double nu = reference::kMeshPoissonRatio, trace = e[0] + e[1];
  return Y / (2 * (1 - nu * nu)) * (nu * trace * trace + (1 - nu) * (e[0] * e[0] + e[1] * e[1] + 2 * e[2] * e[2]));
}

TEST(MeshMembrane, ATriangleHasTheEnergyOfAnIsotropicSheetWhereverItLies) {
  const double Y = 700;
  Eigen::Matrix3d turned;
  turned = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -0.5).normalized());
  for (const auto& flat : {std::array<Eigen::Vector2d, 3>{{{0, 0}, {1, 0}, {0.5, 0.9}}},
                           {{{0, 0}, {0.3, 0.1}, {0, 0.4}}},
                           {{{0.1, 0.2}, {1.1, 0.1}, {-0.3, 0.6}}}}) {
    std::array<Vec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d at = turned * Eigen::Vector3d(flat[k].x(), flat[k].y(), 0.4);
      corners[k] = {at.x(), at.y(), at.z()};
    }
    const Eigen::Vector2d p = flat[1] - flat[0], q = flat[2] - flat[0];
    const double area = std::abs(p.x() * q.y() - p.y() * q.x()) / 2;
    const Eigen::Matrix3d K = reference::triangle_compliance(corners, Y).inverse();
    for (const Eigen::Vector3d& e : {Eigen::Vector3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}, {0.2, -0.4, 0.3}}) {
      Eigen::Vector3d d;
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector2d s = flat[static_cast<std::size_t>((k + 1) % 3)] - flat[static_cast<std::size_t>(k)];
        d[k] = (e[0] * s.x() * s.x() + e[1] * s.y() * s.y() + 2 * e[2] * s.x() * s.y()) / s.norm();
      }
      EXPECT_NEAR(0.5 * d.dot(K * d) / (area * of_sheet(Y, e)), 1, 1e-9);
    }
  }
}

TEST(MeshMembrane, EquilateralTrianglesAreSprings) {
  const Eigen::Matrix3d S = reference::triangle_compliance({{{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}}}, 100);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(S(i, j), i == j ? 4 / (100 * std::sqrt(3.0)) : 0, 1e-12);
}

}  // namespace
}  // namespace clothbench
