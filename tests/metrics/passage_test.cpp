// Wrong side, touch, slip and folds of whole scenes, and what the summary makes of their series.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "metrics/collider_passage.hpp"
#include "metrics/metric_pass.hpp"
#include "metrics/registry.hpp"
#include "prescribed_solver.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

std::map<std::string, double> summary_of(const Scene& scene, const AccuracyPass& pass) {
  return scalars_of({scene, pass});
}

const std::vector<double>& series(const AccuracyPass& p, const std::string& name) {
  for (const MetricSeries& m : p.metrics)
    if (m.name == name) return m.values;
  throw std::runtime_error("no metric " + name);
}

using SpeedOfFrame = std::function<double(int)>;

/// The accuracy pass of a cloth with a prescribed motion; its first vertex says that it has the speed of the frame.
AccuracyPass passed(const Scene& scene, const Path& path, const SpeedOfFrame& speed,
                    const std::vector<double>& margins = {},
                    const nlohmann::json& settings = nlohmann::json::object()) {
  const SolverEntry entry = prescribed(path);
  MetricPass metrics(MetricContext{scene, entry, settings, margins});
  AccuracyPass pass;
  const std::vector<double> start = initial_positions(scene);
  for (int f = 0; f <= scene.time.frames(); ++f) {
    ClothState state{start, std::vector<double>(start.size(), 0)};
    path(f, state.position);
    state.velocity[0] = speed(f);
    metrics.add(state);
    pass.time_s.push_back(scene.time.at(f));
    for (const double x : state.position) pass.position.push_back(static_cast<float>(x));
  }
  pass.metrics = metrics.take();
  return pass;
}

AccuracyPass passed(const Scene& scene, const Path& path, double speed = 0, const std::vector<double>& margins = {},
                    const nlohmann::json& settings = nlohmann::json::object()) {
  return passed(
      scene, path, [speed](int) { return speed; }, margins, settings);
}

const Path kStill = [](int, std::vector<double>&) {};

TEST(Passage, AHandThroughASheetThatStandsStillIsOnItsWrongSide) {
  for (const char* type : {R"(colliders.0.type="hand_capsules")", R"(colliders.0.type="hand_mesh")"}) {
    const Scene scene = load_scene("paper/capsule-sweep", {"cloth.grid=[32,32]", "time.frame_rate_hz=36", type});
    const AccuracyPass pass = passed(scene, kStill);
    const std::vector<double>& wrong = series(pass, "wrong_side_samples");
    // The track: in front until 1 s, 50 mm behind the sheet at 1.25 s, swept from x = 0.3 to -0.3 until 2 s, out
    // at 2.25 s.
    const auto at = [&](double t) { return wrong[static_cast<std::size_t>(std::lround(t * 36))]; };
    EXPECT_EQ(at(0.9), 0) << type;
    EXPECT_EQ(at(1.25), 0) << type << ": straight in, nothing is swept";
    EXPECT_GT(at(1.6), 50) << type;
    EXPECT_GT(at(1.95), at(1.6)) << type;
    EXPECT_EQ(pass.metrics.size() > 0, true);
    const double fraction = series(pass, "wrong_side_fraction")[static_cast<std::size_t>(std::lround(2 * 36))];
    // Some 0.6 m long and a hand high: 0.09 m2 of 1 m2 at the least, and no more than 0.2 m high.
    EXPECT_GT(fraction, 0.06) << type;
    EXPECT_LT(fraction, 0.16) << type;
  }
}

TEST(Passage, ASheetOutOfTheWayIsNot) {
  const Scene scene = load_scene("paper/capsule-sweep", {"cloth.grid=[16,16]"});
  const AccuracyPass pass = passed(scene, [](int frame, std::vector<double>& x) {
    // Pushed back a hand's depth before the hand comes, as a whole, and let back when it has gone.
    for (std::size_t k = 2; k < x.size(); k += 3) x[k] -= frame > 60 && frame < 170 ? 0.2 : 0;
  });
  for (const double w : series(pass, "wrong_side_samples")) EXPECT_EQ(w, 0);
}

TEST(Passage, AHandThroughASheetThatStandsStillHooksIt) {
  // Level, so that the upright sheet is met by the fingers' axes while the hand is in it.
  const Scene scene = load_scene("paper/capsule-sweep", {"cloth.grid=[12,12]"});
  const AccuracyPass pass = passed(scene, kStill);
  const std::vector<double>& hooked = series(pass, "hooked_axes");
  for (std::size_t f = 0; f < hooked.size(); ++f)
    EXPECT_LE(hooked[f], 0 + (series(pass, "contact_length_m")[f] > 0 ? 19 : 0)) << "no axis without a contour";
  // A capsule across the sheet, through it from 0.1 s on until it has gone on by its length and the way there.
  const Scene across = load_scene(
      "paper/capsule-sweep",
      {"cloth.grid=[12,12]", "time.duration_s=1", "time.frame_rate_hz=100",
       R"(colliders=[{"type":"capsule","center_m":[0.013,0.021,0.305],"radius_m":0.02,"length_m":0.4,"axis":[0,0,1],"velocity_m_per_s":[0,0,-1]}])"});
  const AccuracyPass through = passed(across, kStill);
  EXPECT_EQ(series(through, "hooked_axes")[10], 0);
  for (int f = 11; f <= 50; ++f) EXPECT_EQ(series(through, "hooked_axes")[static_cast<std::size_t>(f)], 1) << f;
  EXPECT_EQ(series(through, "hooked_axes")[51], 0);
  for (const double w : series(through, "wrong_side_samples")) EXPECT_EQ(w, 0) << "at right angles it has no wake";
  EXPECT_NEAR(summary_of(across, through).at("hooked_longest_s"), 0.4, 1e-9);
  EXPECT_EQ(summary_of(across, through).at("hooked_end"), 0);
}

// Smaller than a cell and between its vertices: the face touches.
TEST(Passage, AFingertipBetweenVerticesTouches) {
  const auto touching = [](double z) {
    const Scene scene = load_scene(
        "paper/capsule-sweep",
        {"cloth.grid=[11,11]", "time.duration_s=0.05",
         R"(colliders=[{"type":"capsule","center_m":[0.03,0.06,)" + std::to_string(z + 0.1) +
             R"(],"radius_m":0.02,"length_m":0.16,"axis":[0,0,1],"velocity_m_per_s":[0,0,0.001],"margin_m":0.004}])"});
    return series(passed(scene, kStill), "touching_fraction")[0];
  };
  EXPECT_NEAR(touching(0.0049), 1.0 / 200, 1e-12) << "one triangle, a tolerance of 1 mm beyond the margin";
  EXPECT_EQ(touching(0.0051), 0);
}

TEST(Passage, AStillColliderHasNoWrongSide) {
  const Scene scene = load_scene("contact/sphere", {"cloth.grid=[9,9]"});
  const AccuracyPass pass = passed(scene, kStill);
  EXPECT_THROW(series(pass, "wrong_side_samples"), std::runtime_error);
  EXPECT_TRUE(std::isnan(summary_of(scene, pass).at("wrong_side_samples_max")));
}

TEST(Passage, SlidingOnAPlaneIsTheWaySlid) {
  const Scene scene =
      load_scene("contact/plane", {"cloth.grid=[9,9]", "colliders.0.friction=0.3", "time.duration_s=1"});
  const double down = scene.cloth.center_m[1] - scene.colliders[0].margin_m;
  // Laid down at frame 10; from frame 20 on 1 mm a frame along x.
  const AccuracyPass pass = passed(scene, [&](int frame, std::vector<double>& x) {
    for (std::size_t k = 0; k < x.size(); k += 3) {
      x[k] += frame > 20 ? 1e-3 * (frame - 20) : 0;
      x[k + 1] -= frame >= 10 ? down : 0;
    }
  });
  EXPECT_EQ(series(pass, "touching_fraction")[9], 0);
  EXPECT_NEAR(series(pass, "touching_fraction")[10], 1, 1e-12);
  EXPECT_EQ(series(pass, "slip_m")[10], 0) << "it has only just come to lie";
  EXPECT_EQ(series(pass, "slip_m")[20], 0);
  EXPECT_NEAR(series(pass, "slip_m")[21], 1e-3, 1e-12);
  const auto s = summary_of(scene, pass);
  EXPECT_NEAR(s.at("slip_m"), 1e-3 * (scene.time.frames() - 20), 1e-9);
  EXPECT_NEAR(s.at("rest_drift_m_per_s"), 1e-3 * scene.time.frame_rate_hz, 1e-6);
  EXPECT_NEAR(s.at("rest_jitter_m"), 0, 1e-6) << "a steady way does not tremble";
}

/// The distance that contact holds the cloth at is the solver's to tell, in whatever words its settings have for it.
TEST(Passage, TouchIsWhereTheSolverSaysThatItHoldsTheCloth) {
  const Scene scene = load_scene("contact/plane", {"cloth.grid=[9,9]", "time.duration_s=0.1"});
  const auto touching = [&](double height, const std::vector<double>& margins,
                            const nlohmann::json& settings = nlohmann::json::object()) {
    const double down = scene.cloth.center_m[1] - height;
    const Path path = [=](int, std::vector<double>& x) {
      for (std::size_t k = 1; k < x.size(); k += 3) x[k] -= down;
    };
    return series(passed(scene, path, 0, margins, settings), "touching_fraction")[0];
  };
  EXPECT_EQ(touching(0.02, {}), 0) << "the scene's margin is 4 mm";
  EXPECT_EQ(touching(0.02, {kMissing}), 0) << "without one, the scene's counts";
  EXPECT_NEAR(touching(0.02, {0.02}), 1, 1e-12);
  EXPECT_NEAR(touching(0.004, {}), 1, 1e-12);
  EXPECT_EQ(touching(0.004, {0.001}), 0) << "a solver that holds it nearer does not touch it there";
  EXPECT_EQ(touching(0.02, {}, {{"collision_margin_m", 0.02}}), 0) << "no metric reads a solver's setting";
}

TEST(Passage, ACapsuleThatCarriesTheClothDoesNotSlip) {
  const Scene scene = load_scene(
      "contact/plane",
      {"cloth.grid=[9,9]", "time.duration_s=0.5", "time.frame_rate_hz=60",
       R"(colliders=[{"type":"capsule","center_m":[0,0,0],"radius_m":0.1,"length_m":0.4,"axis":[0,0,1],"velocity_m_per_s":[1,0,0],"friction":1}])"});
  const double down = scene.cloth.center_m[1] - 0.1 - scene.colliders[0].margin_m;
  const AccuracyPass pass = passed(scene, [&](int frame, std::vector<double>& x) {
    for (std::size_t k = 0; k < x.size(); k += 3) {
      x[k] += frame / 60.0;
      x[k + 1] -= down;
    }
  });
  EXPECT_GT(series(pass, "touching_fraction")[5], 0);
  for (const double slid : series(pass, "slip_m")) EXPECT_NEAR(slid, 0, 1e-12);
  const auto s = summary_of(scene, pass);
  EXPECT_NEAR(s.at("imposed_speed_m_per_s"), 1, 1e-9);
  EXPECT_EQ(s.at("pop_max_m"), 0) << "it touches to the end, and nothing pops";
}

Path waved(double wavelength_cells, double height, int columns) {
  return [=](int, std::vector<double>& x) {
    for (std::size_t v = 0; v < x.size() / 3; ++v)
      x[3 * v + 1] += height * std::cos(2 * std::numbers::pi *
                                        static_cast<double>(v % static_cast<std::size_t>(columns)) / wavelength_cells);
  };
}

TEST(Folds, ASmoothFoldIsSmoothAndAZigzagIsNot) {
  const Scene scene = load_scene("contact/plane", {"cloth.grid=[33,33]", "time.duration_s=0.02"});
  const auto roughness = [&](const Path& p) { return series(passed(scene, p), "fold_roughness")[0]; };
  EXPECT_EQ(roughness(kStill), 0);
  EXPECT_NEAR(roughness(waved(2, 0.001, 33)), 1, 1e-6);
  EXPECT_NEAR(roughness(waved(4, 0.0001, 33)), 0.25, 0.01) << "sin^4(pi/4)";
  EXPECT_NEAR(roughness(waved(16, 0.0005, 33)), std::pow(std::sin(std::numbers::pi / 16), 4), 2e-4);
  // A gable of two halves at 2 x 0.1 rad: one angle in 31 along u, none along v.
  const double rms = series(passed(scene,
                                   [&](int, std::vector<double>& x) {
                                     for (std::size_t v = 0; v < x.size() / 3; ++v) {
                                       const auto i = static_cast<int>(v % 33);
                                       x[3 * v + 1] += std::tan(0.1) * scene.cloth.du() * std::abs(i - 16);
                                     }
                                   }),
                            "fold_angle_rms_rad")[0];
  EXPECT_NEAR(rms, 2 * std::sin(0.1) / std::sqrt(2 * 31.0), 1e-9);
}

/// A pass of contact lengths alone, one frame every 0.1 s.
AccuracyPass lengths(const std::vector<double>& values) {
  AccuracyPass p;
  for (std::size_t f = 0; f < values.size(); ++f) p.time_s.push_back(0.1 * static_cast<double>(f));
  p.metrics.push_back({"contact_length_m", "m", "", values});
  return p;
}

TEST(Summary, TimesOfViolation) {
  const Scene scene = load_scene("contact/plane", {"cloth.grid=[9,9]"});
  const auto s = summary_of(scene, lengths({0, 0, 1, 1, 0, 2, 2, 2, 0, 0}));
  EXPECT_NEAR(s.at("contact_violated_longest_s"), 0.3, 1e-12);
  EXPECT_NEAR(s.at("untangle_s"), 0.6, 1e-12) << "from the end of frame 1 to the end of frame 7";
  EXPECT_NEAR(s.at("contact_length_mean_m"), 8.0 / 9, 1e-12);
  const auto never = summary_of(scene, lengths({0, 0, 1, 1}));
  EXPECT_TRUE(std::isinf(never.at("untangle_s")));
  const auto clean = summary_of(scene, lengths({0, 0, 0}));
  EXPECT_EQ(clean.at("contact_violated_longest_s"), 0);
  EXPECT_TRUE(std::isnan(clean.at("untangle_s"))) << "nothing was tangled";
  const auto unknown = summary_of(scene, lengths({0, kMissing, kMissing, 0}));
  EXPECT_NEAR(unknown.at("contact_violated_longest_s"), 0.2, 1e-12) << "not known to be clean is not clean";
}

TEST(Summary, RestIsJudgedByItsLastHalfSecond) {
  const Scene scene = load_scene("contact/plane", {"cloth.grid=[9,9]", "time.duration_s=1"});
  const auto s = summary_of(scene, passed(scene, [](int frame, std::vector<double>& x) {
                              for (std::size_t k = 1; k < x.size(); k += 3) x[k] += frame % 2 == 0 ? 1e-3 : -1e-3;
                            }));
  EXPECT_NEAR(s.at("rest_jitter_m"), 2e-3, 1e-6) << "(x - 2 x + x)/2 of a zigzag of 1 mm";
}

}  // namespace
}  // namespace clothbench
