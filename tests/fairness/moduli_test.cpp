// The whole effective moduli through ClothSolver: the reference, whose springs are solved to rounding, has the
// homogenised moduli of its lattice; a solver without a stiffness is found out.
#include <gtest/gtest.h>

#include <cmath>

#include "report/material.hpp"
#include "runner/effective_moduli.hpp"

namespace clothbench {
namespace {

TEST(EffectiveModuli, TheReferenceIsTheIsotropicSheetItDeclares) {
  const SolverEntry& entry = find_solver("reference");
  const RunRecord c = measure_material(entry, complete_settings(entry.info, {{"substeps", 4}}), "default", true, {},
                                       "test", 300, PatchChoice::GridsAndMeshes);
  EXPECT_EQ(c.outcome.status + c.outcome.message, "ok");
  const auto value = [&](const char* name) { return c.summary.at(std::string("material_") + name); };
  for (const char* name : {"E_0", "E_45", "E_90", "E_strip", "E_stiffer", "strip_border"})
    EXPECT_NEAR(value(name), 1, 2e-3) << name;
  EXPECT_NEAR(value("nu"), 1.0 / 3, 2e-3);
  EXPECT_NEAR(value("G"), 0.375, 2e-3);
  for (const char* name : {"B_0", "B_90", "B_stiffer"}) EXPECT_NEAR(value(name), 1, 5e-3) << name;
  EXPECT_NEAR(value("B_45"), 0.5, 0.015) << "lines along the grid resist no twist";
  for (const char* name : {"mesh_E_0", "mesh_E_45", "mesh_E_90"}) EXPECT_NEAR(value(name), 1, 0.01) << name;
  EXPECT_NEAR(value("mesh_nu"), 1.0 / 3, 0.01);
  EXPECT_LE(value("unrest"), 2e-4);
}

TEST(EffectiveModuli, WhoDoesNotStretchHasNone) {
  const SolverEntry& entry = find_solver("ballistic");
  EXPECT_EQ(measure_material(entry, nlohmann::json::object(), "default", true, {}, "test").outcome.status,
            "unsupported");
}

TEST(EffectiveModuli, SettingsAreSweptByName) {
  SolverInfo info;
  info.settings = {{"substeps", "0", ""}, {"iterations", "5", ""}, {"stiffness", "0.5", ""}};
  const auto swept = swept_settings(info, complete_settings(info, nlohmann::json::object()));
  ASSERT_EQ(swept.size(), 2u);
  EXPECT_EQ(swept.at("iterations=20")["substeps"], 0);
  EXPECT_EQ(swept.at("substeps=1024")["iterations"], 5);
}

}  // namespace
}  // namespace clothbench
