// Layout of grid lines: tethers, over-constrained lines, substeps, threads. Needs no device.
#include "xpbd/lines/line_layout.hpp"

#include "gpu_fixture.hpp"
#include "scenario/load.hpp"
#include "xpbd/time/integrator.hpp"

namespace clothbench::pbd_gpu {
namespace {

Scene pinned(Scene s, std::vector<std::uint32_t> vertices) {
  s.pins.vertices = std::move(vertices);
  s.needs.add(Feature::Pins);
  return s;
}

TEST(Tethers, GoToCornersEdgesAndClamps) {
  const Scene s = sheet(9, 7);
  using R = std::vector<PinnedRectangle>;
  EXPECT_EQ(tethers_of(with_pins(s)).to, (R{{0, 0, 0, 0}, {8, 0, 8, 0}}));
  EXPECT_EQ(tethers_of(pinned(s, edge_vertices(s.cloth, "u1"))).to, (R{{8, 0, 8, 6}}));
  EXPECT_EQ(tethers_of(pinned(s, clamp_vertices(s.cloth, "v0"))).to, (R{{0, 0, 8, 1}}));
  EXPECT_EQ(tethers_of(pinned(s, {0, 1, 9})).to, (R{{0, 0, 0, 0}})) << "an L fills no rectangle: one vertex of it";
  EXPECT_EQ(tethers_of(pinned(s, {0, 2, 4, 6, 8, 62})).to.size(), Tethers::kMax);
}

TEST(Tethers, AreNoneWhereTheyWouldBeWrong) {
  EXPECT_EQ(tethers_of(sheet(9, 7)).reason, "nothing is pinned");
  Scene held = with_pins(sheet(9, 7));
  held.grips.vertices = {30};
  EXPECT_TRUE(tethers_of(held).to.empty());
  EXPECT_FALSE(tethers_of(held).reason.empty());
  Scene stretched = with_pins(sheet(9, 7));
  stretched.cloth.axis_u = {1.07, 0, 0};
  EXPECT_EQ(tethers_of(stretched).reason, "the cloth starts stretched");
}

TEST(TautLines, AreThoseStraightBetweenHeldVertices) {
  Scene s = with_pins(sheet(9, 7));
  std::vector<std::uint8_t> expected(36, 0);
  expected[0] = 1;  // row 0
  EXPECT_EQ(over_constrained_lines(s), expected);
  s = pinned(s, {1, 31});  // (1, 0) and (4, 3): on the diagonal that begins at column 1
  expected.assign(36, 0);
  expected[18 + 1] = 1;
  EXPECT_EQ(over_constrained_lines(s), expected);
  s = pinned(s, edge_vertices(s.cloth, "u0"));
  EXPECT_EQ(over_constrained_lines(s), std::vector<std::uint8_t>(36, 0)) << "no free vertex is between two pinned ones";
}

TEST(Substeps, FollowTheRule) {
  const auto of = [](const Scene& s, const char* quality) { return xpbd_substeps(s, {{"quality", quality}}); };
  Scene hang = with_pins(sheet(32, 32));
  EXPECT_EQ(of(hang, "default"), 6) << "tethers with slack";
  hang.material.membrane_stiffness_N_per_m.reset();
  EXPECT_EQ(of(hang, "fast"), 2);
  EXPECT_EQ(of(hang, "default"), 6);
  EXPECT_EQ(of(hang, "accurate"), 20);
  EXPECT_EQ(xpbd_substeps(hang, {{"quality", "fast"}, {"substeps", 7}}), 7);
  EXPECT_EQ(xpbd_substeps(hang, {{"tethers", false}}), 10);
  hang.time.frame_rate_hz = 36;
  EXPECT_EQ(of(hang, "fast"), 2) << "as many per frame: a rule in seconds would treat scaled scenes differently";
  for (const auto& [n, fast] : {std::pair{64, 3}, {128, 5}, {256, 11}, {512, 21}, {1024, 43}}) {
    Scene s = with_pins(sheet(n, 9));
    s.material.membrane_stiffness_N_per_m.reset();
    EXPECT_EQ(of(s, "fast"), fast);
  }
  EXPECT_EQ(of(sheet(128, 128), "default"), 5) << "nothing touches it";
  EXPECT_EQ(of(load_scene("paper/two-hand-stretch-10mps"), "fast"), 80) << "hands pull it apart by more than half";
  EXPECT_EQ(of(load_scene("validation/two-hand-pull"), "default"), 28) << "fewer lose the crests of waves";
}

TEST(Substeps, OfAStripOnAColliderAreMoreInTheFirstFrame) {
  const Scene strip = load_scene("validation/capstan-hold");
  const int later = xpbd_substeps(strip, nlohmann::json::object());
  SubstepController pace(strip, nlohmann::json::object(), true);
  for (int run = 0; run < 2; ++run, pace.reset()) {
    EXPECT_EQ(pace.substeps(), 4 * later);
    pace.next(std::numeric_limits<double>::infinity(), 0);
    EXPECT_EQ(pace.substeps(), 4 * later);
    pace.next(0, 0);
    EXPECT_EQ(pace.substeps(), later) << "even if it rests";
  }
}

TEST(Substeps, OfAFrameAreFewerWhileTheClothRests) {
  const Scene fold = load_scene("contact/self-fold");
  const nlohmann::json settings = nlohmann::json::object();
  const double cell_m = fold.cloth.du();
  SubstepController pace(fold, settings, true);
  EXPECT_EQ(pace.substeps(), 18);
  std::vector<int> calm;
  for (int f = 0; f < 24; ++f) {
    pace.next(cell_m / 25, 0);
    calm.push_back(pace.substeps());
  }
  EXPECT_TRUE(std::is_sorted(calm.rbegin(), calm.rend()));
  EXPECT_EQ(calm.front(), 18);
  EXPECT_EQ(calm.back(), 6) << "a quarter of 24";
  pace.next(cell_m / 7, 0);
  EXPECT_EQ(pace.substeps(), 6) << "not quiescent, and not yet fast";
  pace.next(cell_m / 5, 0);
  EXPECT_EQ(pace.substeps(), 18);
  EXPECT_EQ(pace.lists(), 1);
  pace.next(5 * cell_m, 0);
  EXPECT_EQ(pace.lists(), 3) << "one for two cells";
  for (const double unknown : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    pace.next(unknown, 0);
    EXPECT_EQ(pace.lists(), 4) << "one for four substeps";
  }
  EXPECT_FALSE(SubstepController(fold, settings, false).adapts());
  EXPECT_EQ(SubstepController(fold, {{"substeps", 7}}, false).substeps(), 7);
}

TEST(Substeps, OfASheetOnAColliderGoByItsStrain) {
  Scene ball = load_scene("contact/sphere");
  ball.cloth.columns = ball.cloth.rows = 65;
  SubstepController pace(ball, nlohmann::json::object(), true);
  EXPECT_EQ(pace.substeps(), 16) << "a quarter of 64 links";
  EXPECT_EQ(pace.max_substeps(), 64);
  for (const auto& [strain, substeps] :
       {std::pair{0.0, 16}, {0.09, 24}, {0.09, 32}, {0.2, 32}, {0.07, 32}, {0.05, 24}, {0.05, 18}, {0.05, 16}}) {
    EXPECT_FALSE(pace.repeats(strain));
    pace.next(ball.cloth.du(), strain);
    EXPECT_EQ(pace.substeps(), substeps) << "after strain " << strain;
  }
}

TEST(Substeps, OfAFrameAreDoubledWhileThatReducesAStrainTooLarge) {
  Scene ball = load_scene("contact/sphere");
  ball.cloth.columns = ball.cloth.rows = 65;
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [strains, substeps] : {std::pair{std::vector{0.24}, 16},
                                          {{0.26, 0.1}, 32},
                                          {{inf, 1.0, 0.3}, 64},
                                          {{0.4, 0.31}, 32},
                                          {{nan, 0.1}, 32}}) {
    SubstepController pace(ball, nlohmann::json::object(), true);
    pace.next(0, 0);
    for (std::size_t k = 0; k < strains.size(); ++k) EXPECT_EQ(pace.repeats(strains[k]), k + 1 < strains.size());
    EXPECT_EQ(pace.substeps(), substeps);
    pace.next(0, strains.back());
    EXPECT_EQ(pace.repeats(1.4 * strains.back()), strains.back() > 0.2 && strains.back() <= 0.25) << "tolerated";
    EXPECT_FALSE(pace.repeats(0.1));
    pace.next(0, 0);
    EXPECT_TRUE(pace.repeats(0.26)) << "not tolerated any longer";
  }
}

TEST(Substeps, GrowWithTheSpeedOfWhatComes) {
  Scene s = load_scene("paper/capsule-sweep");
  const auto of = [&](double speed, const char* quality) {
    Scene changed = s;
    for (std::size_t f = 0; f < changed.motion.size(); ++f)
      for (std::size_t k = 0; k < changed.colliders[0].capsules.size(); ++k) {
        Capsule& c = changed.motion[f].colliders[0].capsules[k];
        c = changed.colliders[0].capsules[k];
        c.a_m[0] += speed * static_cast<double>(f) * s.time.dt();
        c.b_m[0] += speed * static_cast<double>(f) * s.time.dt();
      }
    return xpbd_substeps(changed, {{"quality", quality}});
  };
  EXPECT_EQ(of(0.8, "default"), 5) << "31 links / 6; the 11 mm per frame are less than 4 mm per substep";
  EXPECT_EQ(of(5, "default"), 25);
  EXPECT_EQ(of(7.5, "default"), 38);
  EXPECT_EQ(of(5, "fast"), 20);
  EXPECT_EQ(of(100, "fast"), 32) << "the maximum";
  EXPECT_EQ(of(100, "default"), 48) << "the maximum";
  s.jumps = {{2, 1.0}};
  for (std::size_t f = 0; f < s.motion.size(); ++f) {
    s.motion[f].colliders[0].capsules = s.colliders[0].capsules;
    if (f >= 2) s.motion[f].colliders[0].capsules[0].a_m[0] += 1;
  }
  EXPECT_EQ(xpbd_substeps(s, {{"quality", "default"}}), 5) << "a jump is no motion";
}

TEST(Shapes, FitDevices) {
  const LineDevice lavapipe{8, 1024, 32768}, nvidia{32, 1024, 32768, true}, adreno{64, 256, 32768};
  for (const LineDevice& d : {lavapipe, nvidia, adreno})
    for (const int n : {2, 3, 7, 17, 32, 33, 64, 100, 129, 256, 512, 1000, 1024}) {
      for (const LineShape& s : {frame_shape(n, 2, {}, d), frame_shape(n, n, {}, d), pass_shape(n, {}, d)}) {
        if (s.threads == 0) {
          EXPECT_GT(n, 32);
          continue;
        }
        EXPECT_LE(s.threads, std::min(d.wide ? 1024u : 256u, d.max_threads));
        EXPECT_GE(s.lanes * s.vertices, static_cast<std::uint32_t>(n));
        EXPECT_EQ(s.lanes & (s.lanes - 1), 0u);
        EXPECT_EQ(s.threads % (s.lanes * s.beside), 0u);
        EXPECT_EQ(s.threads % std::min(d.subgroup, s.threads), 0u) << "whole subgroups";
      }
    }
  EXPECT_EQ(frame_shape(32, 32, {}, nvidia).threads, 512u);
  EXPECT_EQ(frame_shape(32, 32, {}, adreno).threads, 256u);
  const LineShape wide = pass_shape(512, {}, nvidia);
  EXPECT_EQ(wide.beside * wide.lanes, 512u);
  EXPECT_EQ(pass_shape(64, {2, 128, 2}, nvidia).threads, 128u) << "requests are granted";
  EXPECT_THROW(pass_shape(8193, {}, nvidia), Error);
}

}  // namespace
}  // namespace clothbench::pbd_gpu
