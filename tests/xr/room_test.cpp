#include "assets/room.hpp"

#include <cmath>

#include "null_runtime/script.hpp"
#include "sessions.hpp"
#include "xr/picking.hpp"

namespace clothbench::xr {
namespace {

TEST_F(Sessions, TheUsersDeskIsPickedAndMet) {
  LoopOptions o = options("paper/desk-flat-low", 45);
  o.device.validation = true;
  const LoopResult r = run(o, "clock=virtual,look=16");
  EXPECT_GT(reported_["drawn"][0].get<double>(), 0.1) << "the room is shown at the press of A";
  const Scene scene = load_scene(r.scenario.string());
  const nlohmann::json scenario = parse_json(scene.json, "saved");
  const auto& points = scenario["colliders"][0]["points_m"];
  ASSERT_EQ(points.size(), 6u);
  for (int k = 0; k < 6; ++k) {
    const null_xr::V expected = null_xr::target(20 + 4 * k);
    EXPECT_NEAR(points[static_cast<std::size_t>(k)][0].get<double>(), expected.x, 1e-5);
    EXPECT_NEAR(points[static_cast<std::size_t>(k)][1].get<double>(), expected.y, 1e-5);
    EXPECT_NEAR(points[static_cast<std::size_t>(k)][2].get<double>(), expected.z, 1e-5);
  }
  const assets::Room room = assets::load_room(r.scenario.parent_path() / "room.json");
  EXPECT_EQ(room.mesh.triangles.size(), null_xr::room().indices.size() / 3);
  const std::size_t part = scene.colliders.at(0).mesh->triangles.size();
  EXPECT_GT(part, 2 * 16 * 8u) << "the top of the table";
  EXPECT_LT(part, room.mesh.triangles.size() / 2) << "not the whole room";
  EXPECT_TRUE(scene.assets.empty()) << "a room of the user's own is no asset of ours";
  double lowest = 1e9, highest = 0;
  for (std::size_t v = 1; v < r.final_position_m.size(); v += 3) {
    lowest = std::min(lowest, r.final_position_m[v]);
    highest = std::max(highest, r.final_position_m[v]);
  }
  EXPECT_GT(lowest, null_xr::kTableHigh.y) << "nothing is in the table";
  EXPECT_LT(highest, null_xr::kTableHigh.y + 0.05) << "it has fallen 30 cm onto it";
  EXPECT_EQ(replayed(r, o), r.final_position_m);
}

TEST_F(Sessions, WithoutARoomTheScenariosIsThere) {
  const LoopOptions o = options("paper/desk-flat-low", 8);
  const LoopResult r = run(o, "clock=virtual,blind=1,room=0");
  EXPECT_EQ(load_scene(r.scenario.string()).assets, "procedural");
  EXPECT_EQ(replayed(r, o), r.final_position_m);
}

TEST_F(Sessions, ARoomThatWasNeverScannedIsSaid) {
  setenv("CLOTHBENCH_NULL_XR", "clock=virtual,room=2", 1);
  try {
    run_loop(options("paper/desk-flat-low", 8));
    ADD_FAILURE() << "no error";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("scan the room"), std::string::npos) << e.what();
  }
}

TEST(Picking, TheNearestPointOnARay) {
  assets::TriangleMesh m;
  for (const double z : {-1.0, -2.0}) {
    const auto first = static_cast<std::uint32_t>(m.vertex_count());
    m.add_vertex({-1, -1, z});
    m.add_vertex({1, -1, z});
    m.add_vertex({0, 1, z});
    m.triangles.push_back({first, first + 1, first + 2});
  }
  const auto at = hit(m, {{0.1, 0, 0}, {0, 0, -1}});
  ASSERT_TRUE(at);
  EXPECT_NEAR((*at)[0], 0.1, 1e-12);
  EXPECT_NEAR((*at)[2], -1, 1e-12);
  EXPECT_FALSE(hit(m, {{0.1, 0, 0}, {0, 0, 1}})) << "behind";
  EXPECT_FALSE(hit(m, {{2, 0, 0}, {0, 0, -1}})) << "beside";
  EXPECT_FALSE(hit(m, {{0, 0, -1}, {1, 0, 0}})) << "along";
}

}  // namespace
}  // namespace clothbench::xr
