// Meshes beside grids of as many vertices: which runs make a row, and what it says.
#include "report/mesh_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fake_runs.hpp"

namespace clothbench {
namespace {

RunRecord hung(bool mesh, const std::string& setting, double device_s, double stretch, std::uint32_t vertices = 1024) {
  RunRecord c = fake_run("xpbd", 32, "single", device_s);
  c.header.scene = mesh ? "hang-mesh" : "hang-32";
  c.header.setting = setting;
  c.header.settings = {{"quality", setting}};
  c.header.vertices = vertices;
  c.header.scenario_json = std::string(R"({"name":"hang","material":{"membrane_stiffness_N_per_m":"inextensible"},)") +
                           (mesh ? R"("cloth":{"mesh":{"file":"a.obj"}}})" : R"("cloth":{"grid":[32,32]}})");
  c.header.scenario_sha256 = mesh ? "a" : "b";
  c.summary["frame_device_median_s"] = device_s;
  c.summary["stretch_mean_last_second"] = stretch;
  return c;
}

TEST(MeshesBesideGrids, AreThoseOfOneSettingAndAsManyVertices) {
  const std::vector<RunRecord> runs = {hung(false, "fast", 2e-5, 4e-3),     hung(false, "default", 4e-5, 4e-6),
                                       hung(false, "accurate", 1e-4, 6e-7), hung(true, "default", 1e-4, 1e-3),
                                       hung(true, "accurate", 4e-4, 2e-9),  hung(true, "fast", 1e-5, 1e-2, 900)};
  const auto rows = meshes_beside_grids(runs);
  ASSERT_EQ(rows.size(), 2u) << "no grid has 900 vertices";
  EXPECT_EQ(rows[0].other->header.setting, "default");
  EXPECT_NEAR(rows[0].value, 2.5, 1e-12);
  ASSERT_NE(rows[0].as_taut, nullptr);
  EXPECT_EQ(rows[0].as_taut->header.setting, "default") << "fast is faster and stretches more";
  EXPECT_NEAR(rows[1].value, 4, 1e-12);
  EXPECT_EQ(rows[1].as_taut, nullptr) << "no setting of the grid is as taut";
  EXPECT_TRUE(std::isnan(rows[1].ratio_as_taut()));
  const auto table = parse_markdown(mesh_grid_table(rows).markdown());
  ASSERT_EQ(table.size(), 3u);
  EXPECT_EQ(table[1][5], "0.100");
  EXPECT_EQ(table[1][7], "2.50");
  EXPECT_EQ(table[2].back(), "–");
}

TEST(MeshesBesideGrids, TakeWhatTheStudyNamesAndNoRunThatFailed) {
  std::vector<RunRecord> runs = {hung(false, "default", 4e-5, 4e-6), hung(true, "default", 1e-4, 1e-3, 1029)};
  EXPECT_TRUE(meshes_beside_grids(runs).empty()) << "another number of vertices, and no study that names the grid";
  runs[1].header.environment["pairs"] = nlohmann::json::array(
      {{{"relation", "grid"},
        {"with", {{"scene", nlohmann::json::array({"hang-32"})}, {"setting", nlohmann::json::array({"default"})}}}}});
  EXPECT_EQ(meshes_beside_grids(runs).size(), 1u);
  runs[0].outcome.status = "diverged";
  EXPECT_TRUE(meshes_beside_grids(runs).empty());
}

}  // namespace
}  // namespace clothbench
