// Criteria of the claims in study `reproduction`, on motions known to be correct or wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "scenario/load.hpp"
#include "scenario/study.hpp"
#include "unmet_bounds.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr int kFrames = 108;
constexpr double kStart_m = 0.75, kTop_m = 0.45, kMargin_m = 0.004;

/// A level cloth above a desk, with the acceptance criteria of a claim.
Scene above_desk(const std::string& claim, const json& expect) {
  const json scene = {
      {"name", claim},
      {"why", "A rule on a known motion."},
      {"cloth",
       {{"grid", {9, 9}},
        {"size_m", {0.5, 0.5}},
        {"areal_density_kg_per_m2", 0.2},
        {"sides", "double"},
        {"pose", {{"center_m", {0, kStart_m, 0}}}}}},
      {"material", {{"membrane_stiffness_N_per_m", 1000}}},
      {"colliders",
       {{{"type", "box"}, {"center_m", {0, kTop_m / 2, 0}}, {"size_m", {2, kTop_m, 2}}, {"margin_m", kMargin_m}}}},
      {"time", {{"frame_rate_hz", 72}, {"duration_s", kFrames / 72.0}}},
      {"expect", expect}};
  return scene_from_json(scene, claim);
}

double fallen_m(int frame) { return 0.5 * 9.81 * std::pow(frame / 72.0, 2); }

/// Falls by at most `most_m`.
Path falls(double most_m) {
  return lifted([=](int frame) { return -std::min(most_m, fallen_m(frame)); });
}
const Path kRests = falls(kStart_m - kTop_m - kMargin_m);

/// At rest, except for one half, which falls through the desk.
void half_falls_through(int frame, std::vector<double>& x) {
  const std::vector<double> start = x;
  kRests(frame, x);
  for (std::size_t k = 0; k < x.size(); k += 3)
    if (start[k] > 0.1) x[k + 1] = start[k + 1] - fallen_m(frame);
}

/// Stretched along x to `most` times its length by the middle of the run, then back to `end` times.
Path pulled(double most, double end = 1) {
  return [=](int frame, std::vector<double>& x) {
    const double t = 2.0 * frame / kFrames, scale = t < 1 ? 1 + t * (most - 1) : most + (t - 1) * (end - most);
    for (std::size_t k = 0; k < x.size(); k += 3) x[k] *= scale;
  };
}

/// A vertex in the middle moves within one frame, and stays there.
Path pops(double by_m) {
  return [=](int frame, std::vector<double>& x) {
    if (frame >= kFrames / 2) x[3 * 40 + 1] += by_m;
  };
}

/// Violated criteria, counted as in the report's `claims_of`: without the motion check.
std::string unmet(const Scene& scene, const Path& path) {
  std::string out;
  for (const std::string& name : unmet_bounds(scene, prescribed(path)))
    if (name != "motion") out += name + " ";
  return out;
}

TEST(Claims, RulesHoldOnRightMotionsAndNotOnWrongOnes) {
  std::map<std::string, json> rules;
  for (const Study::Item& item : load_study("reproduction", {{}, StudyLength::Quick}).scenes) {
    const json scene = json::parse(item.scene.json);
    rules[scene["drawn"]["kind"]] = scene["expect"];
  }
  const struct {
    const char *claim, *motion, *unmet;
    Path path;
  } cases[] = {
      {"c8-flat", "rests on the desk", "", kRests},
      {"c8-flat", "rests, stretched by more than the strict bound", "",
       [](int f, auto& x) {
         kRests(f, x);
         pulled(1.6, 1.6)(f, x);
       }},
      {"c8-flat", "hovers", "touching_fraction_end ", falls(0.1)},
      {"c8-flat", "falls through", "crossings_max lowest_height_min_m touching_fraction_end ", falls(20)},
      {"c8-corner", "rests on the desk", "", kRests},
      {"c8-corner", "half of it falls through", "crossings_max lowest_height_min_m ", half_falls_through},
      {"c10-sweep", "moves slowly", "", pulled(1.2)},
      {"c10-sweep", "a vertex jumps by less than is seen", "", pops(0.005)},
      {"c10-sweep", "a vertex jumps", "pop_max_m ", pops(0.03)},
      {"c10-sweep", "falls through and away", "crossings_max lowest_height_min_m ", falls(20)},
      {"c12-push", "is stretched a little", "", pulled(1.4)},
      {"c12-push", "is stretched too far", "stretch_max ", pulled(1.6)},
      {"c12-push", "is passed through", "crossings_max lowest_height_min_m ", falls(20)},
      {"c12-stretch", "recovers", "", pulled(1.8)},
      {"c12-stretch", "is not pulled", "stretch_max ", pulled(1.1)},
      {"c12-stretch", "is stretched too far", "stretch_max ", pulled(2)},
      {"c12-stretch", "stays stretched", "stretch_max_end ", pulled(1.8, 1.1)},
      {"c13-fast-pull", "is torn", "", pulled(2.1)},
      {"c13-fast-pull", "is not torn", "stretch_max ", pulled(1.9)},
  };
  std::set<std::string> claims;
  for (const auto& c : cases) {
    EXPECT_EQ(unmet(above_desk(c.claim, rules.at(c.claim)), c.path), c.unmet) << c.claim << ": " << c.motion;
    claims.insert(c.claim);
  }
  EXPECT_EQ(claims.size(), rules.size()) << "a claim without a motion";
}

}  // namespace
}  // namespace clothbench
