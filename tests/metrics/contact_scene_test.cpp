// From scene file to result file: cloth with a prescribed motion intersects colliders, and the file states how deep.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/json_text.hpp"
#include "scenario/load.hpp"
#include "unmet_bounds.hpp"

namespace clothbench {
namespace {

Scene scene_from(const std::string& text) { return scene_from_json(nlohmann::json::parse(text), "test"); }

const char* const kSphereScene = R"({"name":"sphere-test","why":"A sheet pushed into a sphere.",
  "cloth":{"grid":[97,97],"size_m":[0.24,0.24],"areal_density_kg_per_m2":0.2,"sides":"double","pose":{"center_m":[0,0.2,0]}},
  "material":{"membrane_stiffness_N_per_m":1000},
  "colliders":[{"type":"sphere","center_m":[0,0,0],"radius_m":0.1}],
  "time":{"frame_rate_hz":20,"duration_s":1},
  "expect":{"outcome":"ok","depth_max_m":{"at_most":0.0100001},"contact_length_settled_m":{"at_least":0.26,"at_most":0.28}}})";

TEST(ContactScene, XpbdKeepsTheMarginButAtLeastAHundredthOfAnEdge) {
  for (const SolverEntry& e : solvers())
    for (const auto& [margin_m, kept_m] : {std::pair{"0.004", 0.004}, {"0.0001", 0.001}}) {
      if (e.info.name != "xpbd" || !e.make) continue;
      const Scene scene =
          load_scene("contact/plane", {"cloth.grid=[7,7]", std::string("colliders.0.margin_m=") + margin_m});
      const auto solver = e.make(complete_settings(e.info, nlohmann::json::object()), {});
      solver->load(scene);
      ASSERT_EQ(solver->plan().contact_margins_m.size(), 1u);
      EXPECT_NEAR(solver->plan().contact_margins_m[0], kept_m, 1e-12) << "edges are 0.1 m long";
    }
}

TEST(ContactScene, MarginsThatCannotBeAreFaults) {
  const Scene scene = load_scene("contact/plane", {"cloth.grid=[9,9]"});
  const auto fault = [&](const std::vector<double>& margins) {
    const SolverEntry entry = prescribed([](int, std::vector<double>&) {}, margins);
    const SolverRun run({&scene, &entry, nlohmann::json::object()}, {}, "test");
    return run.outcome().status == "ok" ? std::string() : run.outcome().message;
  };
  EXPECT_EQ(fault({}), "");
  EXPECT_EQ(fault({0.01}), "");
  EXPECT_EQ(fault({kMissing}), "");
  EXPECT_PRED2(mentions, fault({0.01, 0.02}), "2 contact margins of 1 colliders");
  EXPECT_PRED2(mentions, fault({-0.01}), "a contact margin of -0.01 m");
  EXPECT_PRED2(mentions, fault({std::numeric_limits<double>::infinity()}), "a contact margin of inf m");
}

/// Prescribed motions obey no law of motion, so only the scene's own bounds are checked.
bool own_bounds_hold(const RunRecord& r) {
  for (const auto& [name, value] : r.summary)
    if (name.starts_with("expect.") && name != "expect.motion" && value != 1) return false;
  return r.summary.contains("expect.motion");
}

// R = 0.1 m, d = 0.01 m: contour 2 pi sqrt(2Rd - d^2) = 0.27388 m; 0.26148 m if R is 1 % smaller.
TEST(ContactScene, ASheetLoweredIntoASphereGivesTheClosedForms) {
  const SolverEntry solver = prescribed(lifted([](int frame) { return frame < 4 ? 0.0 : -0.11; }));
  const RunRecord r = stored_run(scene_from(kSphereScene), solver);
  const auto at = [&](const char* name) { return r.summary.at(name); };
  EXPECT_EQ(series(r, "contact_length_m")[3], 0);
  EXPECT_LE(at("contact_length_settled_m"), 0.2738778);
  EXPECT_GE(at("contact_length_settled_m"), 0.26148 * 0.99);
  EXPECT_NEAR(at("contact_length_max_m"), at("contact_length_settled_m"), 1e-12);
  EXPECT_NEAR(at("depth_max_m"), 0.01, 1e-12);
  EXPECT_THROW(series(r, "self_contact_pairs"), std::runtime_error) << "the scene has no self-contact";
  EXPECT_NEAR(at("stretch_max"), 0, 1e-12);
  EXPECT_TRUE(own_bounds_hold(r)) << r.outcome.expect;
  EXPECT_EQ(at("expect.outcome"), 1);
  EXPECT_EQ(at("expect.depth_max_m"), 1);
  const std::string tighter = replaced(kSphereScene, "0.0100001", "0.005");
  const RunRecord broken = stored_run(scene_from(tighter), solver);
  EXPECT_PRED2(mentions, broken.outcome.expect, "depth_max_m 0.01 > 0.005");
  EXPECT_EQ(broken.outcome.status, "ok") << "a broken expectation is no failure of the solver";
  EXPECT_EQ(broken.summary.at("expect.depth_max_m"), 0);
  EXPECT_EQ(broken.summary.at("expect.outcome"), 1);
}

TEST(ContactScene, ANaNIsInTheSummaryAndBreaksTheExpectation) {
  const Scene scene = scene_from(kSphereScene);
  const SolverEntry solver = prescribed([](int frame, std::vector<double>& x) {
    if (frame >= 7) x[100] = kMissing;
  });
  const RunRecord r = stored_run(scene, solver);
  EXPECT_EQ(r.outcome.status, "not_finite");
  EXPECT_EQ(r.outcome.failed_frame, 7) << "the first frame that is not finite";
  for (const char* name : {"contact_length_max_m", "depth_max_m", "crossings_max", "stretch_max", "stretch_max_end"})
    EXPECT_TRUE(std::isnan(r.summary.at(name))) << name;
  for (const char* part : {"outcome not_finite, expected ok", "finite (kinematic)",
                           "contact_length_settled_m has no value", "depth_max_m has no value"})
    EXPECT_PRED2(mentions, r.outcome.expect, part);
  EXPECT_EQ(r.summary.at("expect.outcome"), 0);
  EXPECT_EQ(r.summary.at("expect.depth_max_m"), 0);
}

const char* const kSelfScene = R"({"name":"over","why":"A sheet laid over itself.",
  "cloth":{"grid":[17,9],"size_m":[1,0.5],"areal_density_kg_per_m2":0.2,"sides":"double","self_collision":{"thickness_m":0.002}},
  "material":{"membrane_stiffness_N_per_m":1000},"time":{"frame_rate_hz":20,"duration_s":1},
  "expect":{"outcome":"ok","self_contact_pairs_max":{"at_most":0}}})";

/// The sheet's right half is folded over its left half, 5 cm above it; in frames 5 to 9 the far end dips through.
void laid_over(int frame, std::vector<double>& x) {
  for (std::size_t v = 0; v < x.size(); v += 3) {
    const double u = x[v] + 0.5;
    if (u <= 0.5) continue;
    x[v] = 0.5 - u;
    x[v + 1] += 0.05 - (frame >= 5 && frame < 10 ? 0.26 * (u - 0.5) : 0);
  }
}

// Horizontal below, tilted above: the halves cross along one line as long as the sheet is wide.
TEST(ContactScene, ASheetThatCrossesItselfSaysHowFar) {
  const RunRecord r = stored_run(scene_from(kSelfScene), prescribed(laid_over));
  EXPECT_EQ(series(r, "self_contact_pairs")[4], 0);
  EXPECT_NEAR(series(r, "self_contact_length_m")[7], 0.5, 1e-9);
  EXPECT_EQ(series(r, "self_contact_length_m")[10], 0);
  EXPECT_NEAR(r.summary.at("self_contact_length_max_m"), 0.5, 1e-9);
  EXPECT_GE(r.summary.at("self_contact_pairs_max"), 16);
  EXPECT_EQ(series(r, "self_contact_pairs").back(), 0);
  EXPECT_EQ(r.summary.at("self_contact_length_settled_m"), 0);
  EXPECT_EQ(r.summary.at("expect.self_contact_pairs_max"), 0);
  EXPECT_THROW(series(r, "contact_length_m"), std::runtime_error) << "it touches nothing but itself";
}

TEST(ContactScene, WhatACrossedStartHasIsNotNew) {
  const auto always = [](int, std::vector<double>& x) { laid_over(5, x); };
  const RunRecord r = stored_run(scene_from(kSelfScene), prescribed(always));
  EXPECT_GE(series(r, "self_contact_pairs")[0], 16);
  EXPECT_EQ(r.summary.at("self_contact_pairs_max"), 0);
  EXPECT_TRUE(own_bounds_hold(r)) << r.outcome.expect;
}

// A strip slides around a rim: an edge of 57 degrees, or a slab with a border of 4 mm. Another passes through 0.1 m
// behind it.
TEST(ContactScene, AStripThatSlidesAroundARimDoesNotCrossIt) {
  struct Rim {
    const char *positions, *triangles;
    double down_m, forward_m;
  };
  for (const Rim& rim :
       {Rim{"[[-1,0,0],[1,0,0],[1,0,-1],[-1,0,-1],[1,-1.54,-1],[-1,-1.54,-1]]", "[[0,1,2],[0,2,3],[1,0,5],[1,5,4]]",
            0.012, 0.02},
        Rim{"[[-1,0,0],[1,0,0],[1,0,-1],[-1,0,-1],[-1,-0.004,0],[1,-0.004,0],[1,-0.004,-1],[-1,-0.004,-1]]",
            "[[0,1,2],[0,2,3],[0,4,5],[0,5,1],[4,6,5],[4,7,6]]", 0.02, 0.014}})
    for (const bool passes : {false, true}) {
      const double z = passes ? -0.1 : -0.009, down = passes ? 0.2 : rim.down_m, forward = passes ? 0 : rim.forward_m;
      const Scene scene = scene_from(std::string(R"({"name":"rim","why":"A strip at a rim.",
        "cloth":{"grid":[8,2],"size_m":[0.1,0.004],"areal_density_kg_per_m2":0.2,"sides":"double","pose":{"center_m":[0,0.004,0]}},
        "material":{"membrane_stiffness_N_per_m":1000},
        "time":{"frame_rate_hz":20,"duration_s":0.5},"expect":{"crossings_max":{"at_most":0}},
        "colliders":[{"type":"mesh","positions_m":)") +
                                     rim.positions + R"(,"triangles":)" + rim.triangles + "}]}");
      const RunRecord r = stored_run(scene, prescribed([&](int frame, std::vector<double>& x) {
                                       for (std::size_t k = 0; k < x.size(); k += 3)
                                         x[k + 1] -= frame < 5 ? 0 : down, x[k + 2] += z + (frame < 5 ? 0 : forward);
                                     }));
      EXPECT_EQ(r.summary.at("crossings_max") > 0, passes) << rim.triangles;
    }
}

TEST(ContactScene, AHandPushedThroughAStillClothCrossesIt) {
  const Scene scene = load_scene("paper/hand-push", {"time.frame_rate_hz=24"});
  const RunRecord r = stored_run(scene, prescribed([](int, std::vector<double>&) {}));
  EXPECT_GT(r.summary.at("crossings_max"), 0);
  EXPECT_GT(r.summary.at("contact_length_max_m"), 0.1) << "the cloth is round the arm";
  EXPECT_GT(r.summary.at("depth_max_m"), 0.005) << "a hand is that thick";
  EXPECT_LT(r.summary.at("depth_max_m"), 0.05);
  EXPECT_EQ(r.header.environment.at("assets"), "procedural");
}

// Every bound must be on a scalar that the scene's metrics measure; otherwise every run would fail with "has no value".
TEST(ContactScene, NoSceneExpectsWhatItDoesNotMeasure) {
  for (const auto& file : std::filesystem::recursive_directory_iterator(scenario_root())) {
    const std::string folder_name = file.path().parent_path().filename().string();
    if (file.path().extension() != ".json" || (folder_name != "paper" && folder_name != "contact")) continue;
    const bool is_mesh = nlohmann::json::parse(read_text(file.path()))["cloth"].contains("mesh");
    const Scene scene = load_scene(file.path().string(), {is_mesh ? "cloth.mesh.drawn.cells=4" : "cloth.grid=[9,9]"});
    const RunRecord r = stored_run(scene, prescribed([](int, std::vector<double>&) {}));
    EXPECT_EQ(r.outcome.expect.find("no value"), std::string::npos) << scene.name << ": " << r.outcome.expect;
    EXPECT_NE(r.outcome.expect, "not measured") << scene.name;
  }
}

}  // namespace
}  // namespace clothbench
