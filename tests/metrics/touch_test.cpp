// Touch and slip of whole scenes, and the summary values computed from their series.
#include <gtest/gtest.h>

#include <cmath>

#include "scenario/load.hpp"
#include "unmet_bounds.hpp"

namespace clothbench {
namespace {

const Path kStill = [](int, std::vector<double>&) {};

// A fingertip smaller than a cell, between its vertices: the face touches.
TEST(Touch, AFingertipBetweenVerticesTouches) {
  const auto touching = [](double z) {
    const Scene scene = load_scene(
        "paper/capsule-sweep",
        {"cloth.grid=[11,11]", "time.duration_s=0.05",
         R"(colliders=[{"type":"capsule","center_m":[0.03,0.06,)" + std::to_string(z + 0.1) +
             R"(],"radius_m":0.02,"length_m":0.16,"axis":[0,0,1],"velocity_m_per_s":[0,0,0.001],"margin_m":0.004}])"});
    return series(stored_run(scene, prescribed(kStill)), "touching_fraction")[0];
  };
  EXPECT_NEAR(touching(0.0049), 1.0 / 200, 1e-12) << "one triangle, a tolerance of 1 mm beyond the margin";
  EXPECT_EQ(touching(0.0051), 0);
}

TEST(Touch, SlidingOnAPlaneIsTheWaySlid) {
  const Scene scene =
      load_scene("contact/plane", {"cloth.grid=[9,9]", "colliders.0.friction=0.3", "time.duration_s=1"});
  const double down = scene.cloth.center_m[1] - scene.colliders[0].margin_m;
  // Laid down at frame 10; from frame 20 on, 1 mm per frame along x.
  const RunRecord run = stored_run(scene, prescribed([&](int frame, std::vector<double>& x) {
                                     for (std::size_t k = 0; k < x.size(); k += 3) {
                                       x[k] += frame > 20 ? 1e-3 * (frame - 20) : 0;
                                       x[k + 1] -= frame >= 10 ? down : 0;
                                     }
                                   }));
  EXPECT_EQ(series(run, "touching_fraction")[9], 0);
  EXPECT_NEAR(series(run, "touching_fraction")[10], 1, 1e-12);
  EXPECT_EQ(series(run, "slip_m")[10], 0) << "the cloth has only just come to rest";
  EXPECT_EQ(series(run, "slip_m")[20], 0);
  EXPECT_NEAR(series(run, "slip_m")[21], 1e-3, 1e-12);
  EXPECT_NEAR(run.summary.at("slip_m"), 1e-3 * (scene.time.frames() - 20), 1e-9);
}

/// The contact offset is declared by the solver, whatever its settings are called.
TEST(Touch, TouchIsWhereTheSolverSaysThatItHoldsTheCloth) {
  const Scene scene = load_scene("contact/plane", {"cloth.grid=[9,9]", "time.duration_s=0.1"});
  const auto touching = [&](double height, const std::vector<double>& margins) {
    const double down = scene.cloth.center_m[1] - height;
    const Path path = [=](int, std::vector<double>& x) {
      for (std::size_t k = 1; k < x.size(); k += 3) x[k] -= down;
    };
    const RunRecord run = stored_run(scene, prescribed(path, margins));
    for (std::size_t k = 0; k < margins.size() && std::isfinite(margins[k]); ++k) {
      EXPECT_EQ(run.header.plan["contact_margins"][k]["margin_m"], margins[k]);
      EXPECT_EQ(run.header.plan["contact_margins"][k]["collider"], scene.colliders[k].name);
    }
    return series(run, "touching_fraction")[0];
  };
  EXPECT_EQ(touching(0.02, {}), 0) << "the scene's margin is 4 mm";
  EXPECT_EQ(touching(0.02, {kMissing}), 0) << "if the solver states no margin, the scene's counts";
  EXPECT_NEAR(touching(0.02, {0.02}), 1, 1e-12);
  EXPECT_NEAR(touching(0.004, {}), 1, 1e-12);
  EXPECT_EQ(touching(0.004, {0.001}), 0) << "beyond the contact offset of this solver";
}

TEST(Touch, ACapsuleThatCarriesTheClothDoesNotSlip) {
  const Scene scene = load_scene(
      "contact/plane",
      {"cloth.grid=[9,9]", "time.duration_s=0.5", "time.frame_rate_hz=60",
       R"(colliders=[{"type":"capsule","center_m":[0,0,0],"radius_m":0.1,"length_m":0.4,"axis":[0,0,1],"velocity_m_per_s":[1,0,0],"friction":1}])"});
  const double down = scene.cloth.center_m[1] - 0.1 - scene.colliders[0].margin_m;
  const RunRecord run = stored_run(scene, prescribed([&](int frame, std::vector<double>& x) {
                                     for (std::size_t k = 0; k < x.size(); k += 3) {
                                       x[k] += frame / 60.0;
                                       x[k + 1] -= down;
                                     }
                                   }));
  EXPECT_GT(series(run, "touching_fraction")[5], 0);
  for (const double slid : series(run, "slip_m")) EXPECT_NEAR(slid, 0, 1e-12);
  EXPECT_EQ(run.summary.at("pop_max_m"), 0) << "it touches to the end, and nothing pops";
}

}  // namespace
}  // namespace clothbench
