// The arithmetic of the effective moduli on sheets whose answer is known: the continuum's own displacements.
#include <gtest/gtest.h>

#include <cmath>

#include "metrics/material_patch.hpp"
#include "truth/solutions.hpp"

namespace clothbench {
namespace {

constexpr double kDensity = 0.2;

/// Positions of a patch whose vertex at material (u, v) moves by `displacement`.
template <class Fn>
std::vector<double> moved(const Scene& s, Fn displacement) {
  std::vector<double> x;
  for (int j = 0; j < s.cloth.rows; ++j)
    for (int i = 0; i < s.cloth.columns; ++i) {
      const Vec3 at = s.rest_position(i, j), by = displacement(i * s.cloth.du(), j * s.cloth.dv());
      for (std::size_t k = 0; k < 3; ++k) x.push_back(at[k] + by[k]);
    }
  return x;
}

/// A sheet that hangs by its short edge with stiffness E, contraction nu and a sideways drift; s down, t across.
Vec3 hang(const Scene& s, double E, double nu, double drift, double along, double across, bool along_v) {
  const double L = along_v ? s.cloth.height_m : s.cloth.width_m, w = along_v ? s.cloth.width_m : s.cloth.height_m;
  const double q = kDensity * 50 / E, t = across - w / 2;
  const double down = q * (L * along - along * along / 2 - nu * t * t / 2),
               aside = -nu * q * (L - along) * t + drift * q * (L * along - along * along / 2);
  const Vec3& a = along_v ? s.cloth.axis_v : s.cloth.axis_u;
  const Vec3& b = along_v ? s.cloth.axis_u : s.cloth.axis_v;
  return {down * a[0] + aside * b[0], down * a[1] + aside * b[1], down * a[2] + aside * b[2]};
}

TEST(Patches, ReadUniaxialModuli) {
  for (const Patch p : {Patch::HangU, Patch::HangV}) {
    const Scene s = patch_scene(p);
    const bool v = p == Patch::HangV;
    const auto x = moved(s, [&](double a, double b) { return hang(s, 700, 0.2, 0.5, v ? b : a, v ? a : b, v); });
    const auto m = patch_moduli(p, s, x);
    EXPECT_NEAR(m.at(v ? "E_90" : "E_0"), 0.7, 1e-9);
    if (!v) {
      EXPECT_NEAR(m.at("nu"), 0.2, 1e-9);
      EXPECT_NEAR(m.at("skew"), 0.5, 1e-9);
    }
  }
  EXPECT_EQ(*patch_scene(Patch::HangStiffer).material.membrane_stiffness_N_per_m,
            2 * *patch_scene(Patch::HangU).material.membrane_stiffness_N_per_m);
  EXPECT_FALSE(patch_scene(Patch::HangStrip).needs.has(Feature::Shear));
}

TEST(Patches, ReadTheShearModulus) {
  const Scene s = patch_scene(Patch::Shear);
  const auto x = moved(s, [&](double u, double) {
    return Vec3{0, -kDensity * 150 / (2 * 260.0) * u * (s.cloth.width_m - u), 0};
  });
  EXPECT_NEAR(patch_moduli(Patch::Shear, s, x).at("G"), 0.26, 1e-9);
}

TEST(Patches, ReadRigidities) {
  Scene s = patch_scene(Patch::BendU);
  const truth::Nodes shape = truth::cantilever_nodes(512, 0.5 / 0.8);  // B is 0.8 of the requested stiffness
  const double cell = s.cloth.du(), free_m = s.cloth.width_m - cell;
  const auto bent = moved(s, [&](double u, double) {
    if (u <= cell * 1.001) return Vec3{};
    const auto [a, b] = truth::node_position(shape, std::min(1.0, (u - cell) / free_m));
    return Vec3{cell + free_m * a - u, -free_m * b, 0};
  });
  EXPECT_NEAR(patch_moduli(Patch::BendU, s, bent).at("B_0"), 0.8, 1e-6);
  const auto fallen = moved(s, [&](double u, double) { return Vec3{-u, -u, 0}; });
  EXPECT_EQ(patch_moduli(Patch::BendU, s, fallen).at("B_0"), 0) << "a chain has no rigidity";
  const auto broken = moved(s, [](double, double) { return Vec3{NAN, NAN, NAN}; });
  EXPECT_TRUE(std::isnan(patch_moduli(Patch::BendU, s, broken).at("B_0")));

  s = patch_scene(Patch::BendDiagonal);
  const double D = 3, q = kDensity * 9.81;
  const auto bowl = moved(s, [&](double u, double v) {
    const double xi = (u - v) / std::sqrt(2.0);
    return Vec3{0, -q / (24 * D) * std::pow(xi * xi - 0.25, 2), 0};
  });
  EXPECT_NEAR(patch_moduli(Patch::BendDiagonal, s, bowl).at("B_45"), 0.3, 1e-9);
}

/// Positions of a mesh's vertices after a displacement, of u from its least and v from the middle.
template <class Fn>
std::vector<double> moved_mesh(const Scene& s, Fn displacement) {
  std::vector<double> x = initial_positions(s);
  for (std::size_t v = 0; v < s.cloth.vertex_count(); ++v) {
    const Vec3& at = s.cloth.mesh->vertices[v];
    const Vec3 by = displacement(at[0] + s.cloth.width_m / 2, at[1]);
    for (std::size_t k = 0; k < 3; ++k) x[3 * v + k] += by[k];
  }
  return x;
}

TEST(Patches, ReadTheModuliOfMeshes) {
  const std::vector<Patch> all = mesh_patches();
  const char* names[] = {"mesh_E_0", "mesh_E_45", "mesh_E_90"};
  for (std::size_t k = 0; k < 3; ++k) {
    const Scene s = patch_scene(all[k]);
    ASSERT_TRUE(s.cloth.mesh);
    const auto x =
        moved_mesh(s, [&](double u, double v) { return hang(s, 700, 0.2, 0, u, v + s.cloth.height_m / 2, false); });
    const auto m = patch_moduli(all[k], s, x);
    EXPECT_NEAR(m.at(names[k]), 0.7, 1e-9);
    if (k == 0) {
      EXPECT_NEAR(m.at("mesh_nu"), 0.2, 1e-9);
    }
    EXPECT_TRUE(std::isnan(patch_moduli(all[k], s, initial_positions(s)).at(names[k]))) << "nothing stretched";
  }
}

/// Homogenised lattices of springs; columns E_0, nu, G and E_45 as 2 x 2 stiffness matrices give them.
TEST(Patches, TurnModuliBy45Degrees) {
  const auto at_45 = [](double E, double nu, double G, double skew = 0) {
    return modulus_at_45({{"E_0", E}, {"E_90", E}, {"nu", nu}, {"G", G}, {"skew", skew}});
  };
  EXPECT_NEAR(at_45(1, 1.0 / 3, 0.375), 1, 1e-12) << "3/4 Y, 3/8 Y";
  EXPECT_NEAR(at_45(1.5, 0.5, 1), 2.4, 1e-12) << "both springs alike";
  EXPECT_NEAR(at_45(1.2, 0.2, 0.25), 0.75, 1e-12) << "areas over squared lengths, alternating diagonals";
  EXPECT_TRUE(std::isnan(at_45(1, 0, 0.3, 0.2))) << "one-diagonal sheets have no axes of symmetry along the grid";
  EXPECT_TRUE(std::isnan(modulus_at_45({{"E_0", 1}})));
}

}  // namespace
}  // namespace clothbench
