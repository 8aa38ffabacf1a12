// Elastic triangle meshes are isotropic sheets: triangles of constant strain, in `xpbd` and in `reference`.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "clothbench/record.hpp"
#include "clothbench/vector.hpp"
#include "contact_scenes.hpp"
#include "mesh_scene.hpp"
#include "scenario/cloth_mesh.hpp"
#include "xpbd/mesh/matrices.hpp"
#include "xpbd/time/integrator.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// A sheet of width x height m along x and y, pinned along x = 0. Its inner vertices are a square lattice, rotated by
/// an angle, each moved by up to a fraction of a cell.
Scene random_sheet(double width, double height, int cells, double angle, double share, unsigned seed) {
  ClothMesh mesh = drawn_mesh({width, height, cells, angle, share, seed});
  std::vector<std::uint32_t> pins = mesh.groups.at("u0");
  return of_mesh(std::move(mesh), std::move(pins));
}

struct IsotropicModuli {
  double E;   ///< divided by the scene's Y
  double nu;  ///< Poisson's ratio
};

/// Moduli of a flat triangle mesh that hangs along axis_u by its smallest u and has come to rest at `position` [m], xyz
/// interleaved. The exact displacement is (p/E) (L u - u^2/2 - nu v^2/2) along u and -nu (p/E) (L - u) v across it,
/// with p = density times gravity and v from the middle. It is fitted, together with a rigid motion, by least squares
/// to the vertices from 0.4 L to 0.9 L. NaN if there are too few of them, or if the sheet has not become longer.
IsotropicModuli hanging_moduli(const Scene& s, const std::vector<double>& position) {
  constexpr double kFirst = 0.4, kLast = 0.9;  // of the length: both edges disturb the displacement
  const std::vector<Vec3>& rest = s.cloth.mesh->vertices;
  const auto sides = [&](std::size_t k) {
    const auto [least, most] =
        std::minmax_element(rest.begin(), rest.end(), [k](const Vec3& a, const Vec3& b) { return a[k] < b[k]; });
    return std::pair((*least)[k], (*most)[k]);
  };
  const auto [u0, u1] = sides(0);
  const auto [v0, v1] = sides(1);
  const double L = u1 - u0, Y = *s.material.membrane_stiffness_N_per_m;
  const double p = s.cloth.areal_density_kg_per_m2 * dot(s.gravity_m_per_s2, s.cloth.axis_u);
  const std::vector<double> start = initial_positions(s);
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (rest[i][0] - u0 >= kFirst * L && rest[i][0] - u0 <= kLast * L) used.push_back(i);
  constexpr std::size_t kUnknowns = 4;
  if (used.size() <= kUnknowns) return {kMissing, kMissing};
  const auto n = static_cast<Eigen::Index>(used.size());
  Eigen::MatrixXd along(n, 4), across(n, 3);
  Eigen::VectorXd moved_u(n), moved_v(n);
  for (Eigen::Index row = 0; row < n; ++row) {
    const std::size_t i = used[static_cast<std::size_t>(row)];
    const double u = rest[i][0] - u0, v = rest[i][1] - (v0 + v1) / 2;
    const Vec3 moved = {position[3 * i] - start[3 * i], position[3 * i + 1] - start[3 * i + 1],
                        position[3 * i + 2] - start[3 * i + 2]};
    along.row(row) << 1, v, v * v, p / Y * (L * u - u * u / 2);
    across.row(row) << 1, u, -p / Y * (L - u) * v;
    moved_u[row] = dot(moved, s.cloth.axis_u);
    moved_v[row] = dot(moved, s.cloth.axis_v);
  }
  const double per_E = along.colPivHouseholderQr().solve(moved_u)[3],
               nu = across.colPivHouseholderQr().solve(moved_v)[2];
  if (!(per_E > 0)) return {kMissing, kMissing};
  return {1 / per_E, nu / per_E};
}

Eigen::Matrix3d matrix_of(const TriangleStiffness& k) {
  Eigen::Matrix3d K;
  K << k.along_N_m[0], k.cross_N_m[0], k.cross_N_m[2], k.cross_N_m[0], k.along_N_m[1], k.cross_N_m[1], k.cross_N_m[2],
      k.cross_N_m[1], k.along_N_m[2];
  return K;
}

TEST(MeshMembrane, TrianglesHaveTheEnergyOfAnIsotropicSheet) {
  const Scene s = random_sheet(1, 0.5, 6, 0.4, 0.3, 1);
  const ClothMesh& mesh = *s.cloth.mesh;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Matrix3d K = matrix_of(triangle_stiffness(mesh, t, *s.material.membrane_stiffness_N_per_m));
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(K).eigenvalues()[0], 0);
    std::array<Eigen::Vector2d, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = Eigen::Vector2d::Map(mesh.vertices[mesh.triangles[t][k]].data());
    for (const Eigen::Vector3d& e : {Eigen::Vector3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}, {1, -0.4, 0.3}})
      EXPECT_NEAR(energy_over_sheet(corners, K, 1000, e), 1, 1e-9) << "triangle " << t;
  }
}

class MembraneOf : public Gpu {
 protected:
  /// A strip 4 : 1 that hangs at rest, its lattice rotated by an angle, with 1 % strain at its top.
  static Scene hanging(int cells, double angle, double share, unsigned seed) {
    Scene s = with_damping(random_sheet(1, 0.25, cells, angle, share, seed));
    s.gravity_m_per_s2 = {50, 0, 0};
    s.material.damping_per_s = 20;
    s.time = {60, 0.8};
    return s;
  }
};

TEST_F(MembraneOf, DrawnMeshesIsTheStatedOne) {
  for (std::size_t k = 0; k < 6; ++k) {
    const auto seed = static_cast<unsigned>(k + 1);
    if (!in_turn(k == 1 ? 0 : 1)) continue;
    const double angle = std::numbers::pi / 4 * static_cast<double>(k % 3), share = k < 3 ? 0.3 : 0.15;
    const Scene s = hanging(12, angle, share, seed);
    ASSERT_TRUE(membrane_decision(s, nlohmann::json::object()).enabled);
    for (const auto& [solver, settings] : {std::pair<std::string, nlohmann::json>{"xpbd", nlohmann::json::object()},
                                           {"xpbd", {{"quality", "fast"}}},
                                           {"reference", {{"substeps", 1}}}}) {
      const IsotropicModuli m = hanging_moduli(s, end_of(s, solver, settings).position);
      EXPECT_NEAR(m.E, 1, 0.02) << solver << settings << ", seed " << seed;
      EXPECT_NEAR(m.nu, 1.0 / 3, 0.02) << solver << settings << ", seed " << seed;
    }
  }
}

TEST_F(MembraneOf, StiffMeshesHasMoreSubstepsBeforeSpringsReplaceIt) {
  Scene s = hanging(12, 0, 0.3, 1);
  const int n = xpbd_substeps(s, nlohmann::json::object());
  bool had_more = false, had_springs = false;
  for (double Y = 1e3; Y < 1e9; Y *= 1.5) {
    s.material.membrane_stiffness_N_per_m = Y;
    const int substeps = xpbd_substeps(s, nlohmann::json::object());
    const bool is_membrane = membrane_decision(s, nlohmann::json::object()).enabled;
    had_more |= substeps > n;
    had_springs |= !is_membrane;
    EXPECT_LE(substeps, is_membrane ? 2 * n : n) << Y;
  }
  EXPECT_TRUE(had_more && had_springs);
}

/// Free sheets of triangles, with and without bending, that rotate and fall: bit-identical repeats, momentum conserved.
TEST_F(MembraneOf, FreeSheetsRepeatAndFallFreely) {
  constexpr int kFrames = 10;
  for (auto [s, tolerance] :
       {std::pair{random_sheet(1, 0.5, 8, 0.5, 0.3, 5), 3e-5}, {with_bending(mesh_sheet(12)), 1e-5}}) {
    s.pins.vertices.clear();
    s.needs = s.needs - FeatureSet{Feature::Pins};
    s.cloth.spin_rad_per_s = {3, 0, 1};
    s.needs.add(Feature::Spin);
    if (s.needs.has(Feature::Bend)) s.material.bending_rigidity_N_m = 1e-3;
    const auto solver = make("xpbd");
    solver->load(s);
    const ClothState once = after(*solver, s, kFrames);
    solver->reset();
    EXPECT_EQ(after(*solver, s, kFrames).position, once.position);
    const std::vector<double> m = vertex_masses(s), start = initial_positions(s), thrown = initial_velocities(s);
    double fall = 0, mass = 0;
    for (std::size_t v = 0; v < m.size(); ++v) {
      const double flown = kFrames * s.time.dt() * thrown[3 * v + 1];
      fall += m[v] * (once.position[3 * v + 1] - start[3 * v + 1] - flown);
      mass += m[v];
    }
    const double free = xpbd_free_fall_m(s, complete_settings(xpbd_info(), {}), kFrames);
    EXPECT_NEAR(fall / mass, free, tolerance * std::abs(free));
  }
}

}  // namespace
}  // namespace clothbench::pbd_gpu
