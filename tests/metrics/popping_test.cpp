// Popping of known motions: a vertex that snaps, a released spring, swept and dropped cloth, a cracking whip.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "metrics/registry.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

/// Displacement [m] of vertex `v` of a grid of 9 by 9 at a time [s].
using Motion = std::function<Vec3(std::size_t v, double time_s)>;

constexpr std::size_t kMiddle = 40, kCorner = 80;
constexpr double kStart_s = 0.25;  ///< frame-aligned at 36, 60, 72 and 144 Hz

const std::string kLevelSheet = "contact/plane";
const std::string kFarBelow = R"(colliders=[{"type":"plane","point_m":[0,-9,0]}])";

Scene scene_of(double rate_hz, const std::string& colliders = kFarBelow) {
  return load_scene(kLevelSheet, {"cloth.grid=[9,9]", "time.duration_s=0.75",
                                  fmt::format("time.frame_rate_hz={}", rate_hz), colliders});
}

AccuracyPass moved(const Scene& scene, const Motion& motion) {
  AccuracyPass pass;
  const std::vector<double> start = initial_positions(scene);
  for (int f = 0; f <= scene.time.frames(); ++f) {
    pass.time_s.push_back(scene.time.at(f));
    for (std::size_t v = 0; v < start.size() / 3; ++v) {
      const Vec3 by = motion(v, scene.time.at(f));
      for (std::size_t k = 0; k < 3; ++k) pass.position.push_back(static_cast<float>(start[3 * v + k] + by[k]));
    }
  }
  return pass;
}

double pop_of(const Scene& scene, const AccuracyPass& pass) {
  return scalars_of({scene, pass}, "pop_").at("pop_max_m");
}
double pop_of(const Scene& scene, const Motion& motion) { return pop_of(scene, moved(scene, motion)); }

double bound_m() {
  for (const StrictBound& b : strict_contact())
    if (std::string(b.scalar) == "pop_max_m") return b.at_most;
  return kMissing;
}

/// 0 until the start, then linearly up to 1.
double ramp(double time_s, double lasts_s) { return std::clamp((time_s - kStart_s) / lasts_s, 0.0, 1.0); }

Motion snapped(double by_m, double in_s, const std::vector<std::size_t>& vertices = {kMiddle}) {
  return [=](std::size_t v, double t) {
    return Vec3{0, std::ranges::count(vertices, v) > 0 ? by_m * ramp(t, in_s) : 0, 0};
  };
}

constexpr double kRounding_m = 1e-6;  // of positions in float32

TEST(Popping, OfASnapIsItsWayAndLessTheLongerItTakes) {
  const Scene scene = scene_of(72);
  const std::vector<std::size_t> patch = {30, 31, 32, 39, 40, 41, 48, 49, 50};
  for (const double way_m : {0.01, 0.03, 0.1}) {
    for (const auto& [frames, share] : {std::pair{1, 1.0}, {2, 1.0}, {3, 1.0 / 3}, {10, 0.0}})
      for (const auto& vertices : {std::vector{kMiddle}, {kCorner}, patch})
        EXPECT_NEAR(pop_of(scene, snapped(way_m, frames / 72.0, vertices)), share * way_m, kRounding_m);
    double before = way_m;
    for (int frames = 1; frames <= 10; ++frames) {
      const double now = pop_of(scene, snapped(way_m, frames / 72.0));
      EXPECT_LE(now, before + kRounding_m) << frames;
      before = now;
    }
  }
  const auto fails = [&](double m, int n) { return !(pop_of(scene, snapped(m, n / 72.0)) <= bound_m()); };
  EXPECT_TRUE(fails(0.03, 1) && fails(0.1, 1) && fails(0.1, 3) && fails(0.026, 1));
  EXPECT_FALSE(fails(0.024, 1) || fails(0.01, 3) || fails(0.01, 10) || fails(0.03, 10) || fails(0.1, 10));
}

TEST(Popping, OfAReleasedSpringFollowsFromItsSpeed) {
  const Scene scene = scene_of(72);
  constexpr double kStretched_m = 0.05, kWindow_s = 1.0 / 36;
  for (const double speed : {10.0, 5.0, 2.5, 1.5, 0.5}) {
    const double time_s = kStretched_m / speed, left = std::exp(-kWindow_s / time_s);
    const Motion springs_back = [&](std::size_t v, double t) {
      return Vec3{v == kCorner ? kStretched_m * std::exp(-std::max(0.0, t - kStart_s) / time_s) : 0, 0, 0};
    };
    EXPECT_NEAR(pop_of(scene, springs_back), std::max(0.0, kStretched_m * (1 - left) * (1 - 2 * left)), kRounding_m);
  }
}

TEST(Popping, IsNoneWhereAHandOrAGripTakesTheClothAlong) {
  const auto swept = [](std::size_t v, double t) {  // reaches 13 m/s from rest and returns to rest
    return Vec3{v % 9 > 2 ? 0.3 * ramp(t, 0.3 / 13) : 0, 0, 0};
  };
  const std::string hand =
      R"(colliders=[{"type":"capsule","center_m":[0,1,0],"radius_m":0.1,"length_m":0.4,"axis":[0,0,1],"velocity_m_per_s":[13,0,0],"start_s":0.25,"stop_s":0.2730769}])";
  EXPECT_EQ(pop_of(scene_of(72, hand), swept), 0);
  EXPECT_NEAR(pop_of(scene_of(72), swept), 0.3, kRounding_m) << "nothing moves it";
  const Scene gripped =
      load_scene(kLevelSheet, {"cloth.grid=[9,9]", "time.duration_s=0.75", "time.frame_rate_hz=72",
                               R"(grips=[{"edge":"u1","velocity_m_per_s":[13,0,0],"stop_s":0.023}])"});
  const auto pulled = [](std::size_t v, double t) { return Vec3{v % 9 > 2 ? std::min(13 * t, 0.3) : 0, 0, 0}; };
  EXPECT_NEAR(pop_of(gripped, pulled), 0, kRounding_m);
  EXPECT_GT(pop_of(scene_of(72), pulled), 10 * bound_m());
}

TEST(Popping, IsNoneInAFallAndWhereASheetStopsOnAPlane) {
  for (const double rate : {36.0, 60.0, 72.0, 144.0}) {
    const Scene scene = scene_of(rate);
    const auto fallen = [](double t) { return -5 * t - 9.81 / 2 * t * t; };
    EXPECT_NEAR(pop_of(scene, [&](std::size_t, double t) { return Vec3{0, fallen(t), 0}; }), 0, kRounding_m) << rate;
    const auto stopped = [&](std::size_t, double t) { return Vec3{0, std::max(fallen(t), -0.9), 0}; };
    EXPECT_NEAR(pop_of(scene, stopped), 0, kRounding_m) << rate;
  }
}

/// A wave moves the free edge at up to twice the speed of the other vertices, and a wave along the diagonal moves the
/// corner at up to four times it. That is not popping, but the same motion of only the edge or the corner is.
TEST(Popping, OfAWhipAndOfACornerIsWhatTheirWaveDoesNotExplain) {
  const Scene scene = scene_of(72);
  const auto popped = [&](bool corner, double gain, bool only) {
    return pop_of(scene, [=](std::size_t v, double t) {
      const double front = static_cast<double>(corner ? v % 9 + v / 9 : v % 9), gap_s = corner ? 0.007 : 0.014;
      const double by = 4 * std::clamp(t - kStart_s - gap_s * front, 0.0, 1.0 / 36);  // 4 m/s
      const bool free = corner ? v == kCorner : v % 9 == 8;
      return Vec3{0, free ? gain * by : only ? 0 : by, 0};
    });
  };
  for (const bool corner : {false, true}) {
    EXPECT_NEAR(popped(corner, corner ? 4 : 2, false), 0, kRounding_m);
    EXPECT_GT(popped(corner, corner ? 6 : 4, false), 2 * bound_m());
    EXPECT_GT(popped(corner, corner ? 1 : 2, true), 4 * bound_m());
  }
}

/// A neighbour's motion is measured by path length, even if it reverses within a window. Distant motion does not
/// matter, and a vertex that jumps and returns does not explain its own jump.
TEST(Popping, OfAVertexAmongOthersThatTurnRound) {
  const Scene scene = scene_of(72);
  const auto among = [](std::size_t from, std::size_t to) -> Motion {
    return [=](std::size_t v, double t) {
      const double there_and_back = std::max(0.0, 1 - std::abs((t - kStart_s) * 72 + 1));
      const bool turns = v % 9 >= from && v % 9 < to && v != kMiddle;
      return Vec3{turns ? 0.03 * there_and_back : 0, v == kMiddle ? 0.05 * ramp(t, 1 / 72.0) : 0, 0};
    };
  };
  EXPECT_NEAR(pop_of(scene, among(3, 6)), 0, kRounding_m);
  EXPECT_NEAR(pop_of(scene, among(7, 9)), 0.05, kRounding_m);
  const auto jumps_back = [](std::size_t v, double t) {
    return Vec3{0, v == kMiddle ? 0.05 * (ramp(t, 1 / 72.0) - ramp(t - 2 / 72.0, 1 / 72.0)) : 0, 0};
  };
  EXPECT_NEAR(pop_of(scene, jumps_back), 0.05, kRounding_m);
}

TEST(Popping, OfOneFrameIsTheSameAtEveryFrameRate) {
  for (const double rate : {8.0, 24.0, 28.0, 36.0, 60.0, 72.0, 144.0, 960.0})
    EXPECT_NEAR(pop_of(scene_of(rate), snapped(0.05, 1 / rate)), 0.05, kRounding_m) << rate;
  for (const double rate : {60.0, 90.0, 120.0}) {
    EXPECT_NEAR(pop_of(scene_of(rate), snapped(0.05, 0.2)), 0, kRounding_m) << rate;
    const auto waved = [](std::size_t, double t) { return Vec3{0, 0, 0.3 * std::sin(2 * std::numbers::pi * t)}; };
    EXPECT_NEAR(pop_of(scene_of(rate), waved), 0, kRounding_m) << rate;
  }
}

/// A snap may begin at any time within a frame. Its value is then at most the value of an equally long snap that begins
/// with a frame, and at least the value of such a snap that lasts one frame longer.
TEST(Popping, OfASnapThatBeginsWithinAFrameIsBounded) {
  for (const double rate : {36.0, 60.0, 72.0, 90.0, 120.0}) {
    const Scene scene = scene_of(rate);
    const double window = std::max(2.0, std::ceil(rate / 36));
    const auto share = [&](double frames) { return std::clamp(2 * window / frames - 1, 0.0, 1.0); };
    for (double frames = 0.25; frames < 2 * window + 1; frames += frames < 4 ? 0.25 : 1)
      for (const double phase : {0.0, 0.2, 0.5, 0.7, 0.9}) {
        const Motion snap = [&](std::size_t v, double t) {
          return Vec3{0, v == kMiddle ? 0.05 * ramp(t - phase / rate, frames / rate) : 0, 0};
        };
        const double pop = pop_of(scene, snap) / 0.05;
        EXPECT_LE(pop, share(frames) + kRounding_m / 0.05) << rate << " Hz, " << frames << " frames, from " << phase;
        EXPECT_GE(pop, share(frames <= 1 ? 1 : frames + 1) - kRounding_m / 0.05)
            << rate << " Hz, " << frames << " frames, from " << phase;
      }
  }
}

/// A snap from frame 18 to 19 is detected once the window after it is complete, and in every longer prefix.
TEST(Popping, IsSeenOnceTheWindowAfterItIsWhole) {
  const Scene scene = scene_of(72);
  const AccuracyPass snap = moved(scene, snapped(0.06, 1.0 / 72));
  for (std::size_t frames = 1; frames <= snap.time_s.size(); ++frames) {
    AccuracyPass prefix = snap;
    prefix.time_s.resize(frames);
    prefix.position.resize(frames * 3 * scene.cloth.vertex_count());
    EXPECT_NEAR(pop_of(scene, prefix), frames > 21 ? 0.06 : 0, kRounding_m) << frames;
  }
}

TEST(Popping, OfAPositionThatIsNoNumberIsNotKnown) {
  for (const double rate : {50.0, 72.0}) {
    const Scene scene = scene_of(rate);
    for (const double at : {0.0, 0.5, 1.0}) {
      AccuracyPass pass = moved(scene, snapped(0, 1));
      pass.position[static_cast<std::size_t>(at * static_cast<double>(pass.position.size() - 1))] = std::nanf("");
      EXPECT_TRUE(std::isnan(pop_of(scene, pass))) << at;
    }
  }
}

/// Rows at heights a and -a: the Laplacian is 4a/3 long; its mean over the neighbours is 4a/9 long and opposite.
TEST(Roughness, OfRowsUpAndDownIsItsClosedForm) {
  const Scene scene = scene_of(72);
  constexpr double kHeight_m = 1e-4, kEdge_m = 0.075 * (144 + 64 * std::numbers::sqrt2) / 208;
  const auto roughness = [&](double height_m) {
    const auto rows = [=](std::size_t v, double) { return Vec3{0, v / 9 % 2 ? height_m : -height_m, 0}; };
    return scalars_of({scene, moved(scene, rows)}, "rough").at("roughness_end");
  };
  EXPECT_NEAR(roughness(0), 0, 1e-6);
  EXPECT_NEAR(roughness(kHeight_m), 16.0 / 9 * kHeight_m / kEdge_m, 1e-5);
}

}  // namespace
}  // namespace clothbench
