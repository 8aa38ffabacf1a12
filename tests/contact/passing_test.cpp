// Random analytic motions of a rigid finger and a ruled sheet, with what must count: through it, round its rim, under
// a fold. All of it turned and mirrored at random.
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "meshes.hpp"
#include "metrics/contact/contact_probe.hpp"
#include "metrics/contact/touch.hpp"
#include "metrics/contact/wrong_side.hpp"

namespace clothbench::contact {
namespace {

using P = Point<3>;

constexpr int kCells = 20;
constexpr unsigned kSeeds = 16;

/// A place in the plane across the finger and the rules: x, z.
using Place = Point<2>;

/// What happens in the plane: the finger's axis and the sheet's profile, by time 0 to 1.
struct Motion {
  std::function<Place(double t)> finger;
  std::function<Place(double s, double t)> profile;  ///< s: along the flat sheet
  double radius_m = 0.02, half_length_m = 0.3;
  int frames = 20;
};

/// A motion in space: rules and finger along y, the sheet's grid turned in its plane, everything turned or mirrored.
class Stage {
 public:
  Stage(const Motion& motion, std::mt19937& random) : motion_(motion) {
    std::uniform_real_distribution<double> unit(-1, 1);
    grid_turn_ = 3 * unit(random);
    const P axis = P(unit(random), unit(random), unit(random) + 2).normalized();
    pose_ = Eigen::AngleAxisd(3 * unit(random), axis).toRotationMatrix();
    for (int k = 0; k < 3; ++k)
      if (unit(random) < 0) pose_.col(k) *= -1;
    flat_ = sheet(kCells, kCells, P(-0.5, -0.5, 0), P(1, 0, 0), P(0, 1, 0));
    links_ = edges_of(flat_.triangles);
  }

  P side() const { return pose_ * P(0, 0, 1); }
  std::size_t vertices() const { return flat_.positions.size() / 3; }
  const std::vector<Link>& links() const { return links_; }
  /// Where a vertex lies in the flat sheet: along the profile, along the rules.
  Place flat_place(std::size_t v) const {
    const double x = flat_.positions[3 * v], y = flat_.positions[3 * v + 1];
    return {std::cos(grid_turn_) * x - std::sin(grid_turn_) * y, std::sin(grid_turn_) * x + std::cos(grid_turn_) * y};
  }
  Mesh cloth(double t) const {
    Mesh out{{}, flat_.triangles};
    for (std::size_t v = 0; v < vertices(); ++v) {
      const Place at = flat_place(v), moved = motion_.profile(at[0], t);
      out.add(pose_ * P(moved[0], at[1], moved[1]));
    }
    return out;
  }
  Capsule finger(double t) const {
    const Place at = motion_.finger(t);
    return {pose_ * P(at[0], -motion_.half_length_m, at[1]), pose_ * P(at[0], motion_.half_length_m, at[1]),
            motion_.radius_m};
  }

 private:
  Motion motion_;
  double grid_turn_ = 0;
  Eigen::Matrix3d pose_;
  Mesh flat_;
  std::vector<Link> links_;
};

struct Seen {
  std::vector<bool> wrong, laid_over;  ///< at the end
  std::size_t wrong_most = 0, laid_over_end = 0;
  double contour_most_m = 0;
};

/// `elsewhere`: the object has a contour in every frame, somewhere that the motion does not show.
Seen watch(const Stage& stage, int frames, bool elsewhere) {
  const auto bones = [](const Capsule& c) { return std::vector<Bone>{{c.a, c.b}}; };
  Capsule finger = stage.finger(0);
  ContactProbe probe(stage.cloth(0).view(), {&finger, 1});
  WrongSide sides(bones(finger), stage.side(), 10, stage.vertices(), stage.links());
  Seen seen;
  double before = 0;
  for (int f = 0; f <= frames; ++f) {
    finger = stage.finger(static_cast<double>(f) / frames);
    const Mesh cloth = stage.cloth(static_cast<double>(f) / frames);
    probe.move_shapes({&finger, 1});
    const double contour = probe.probe(cloth.positions).contour_length_m;
    const auto crosses = [&](const P& p, const P& q) {
      return squared_distance(p, q, finger.a, finger.b) < finger.radius_m * finger.radius_m;
    };
    sides.advance(cloth.positions, bones(finger), {elsewhere || contour > 0 || before > 0, crosses});
    before = contour;
    seen.contour_most_m = std::max(seen.contour_most_m, contour);
    seen.wrong_most = std::max(seen.wrong_most, sides.count());
  }
  for (std::size_t v = 0; v < stage.vertices(); ++v) {
    seen.wrong.push_back(sides.wrong(v));
    seen.laid_over.push_back(sides.laid_over(v));
    seen.laid_over_end += sides.laid_over(v);
  }
  return seen;
}

/// The way between corners at times 0, 1/n, 2/n...
Place along(const std::vector<Place>& corners, double t) {
  const double at = t * static_cast<double>(corners.size() - 1);
  const auto k = std::min(static_cast<std::size_t>(at), corners.size() - 2);
  return corners[k] + (at - static_cast<double>(k)) * (corners[k + 1] - corners[k]);
}

/// Random numbers of one case.
struct Draw {
  explicit Draw(unsigned seed) : random(seed) {}
  double operator()(double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); }
  std::mt19937 random;
};

void for_every_seed(const std::function<void(Draw&)>& check) {
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(seed);
    check(draw);
  }
}

// Down through the sheet, which opens and closes, and on below it: the strip between has been passed.
void through(Draw& draw) {
  const double radius = draw(0.012, 0.03), wave = draw(0, 0.015), phase = draw(0, 6), gap = draw(0, 0.04);
  const double slope = draw(-0.3, 0.3), x0 = draw(-0.1, 0.1), direction = draw(-1, 1) < 0 ? -1 : 1;
  const double end = x0 + direction * draw(0.22, 0.3);
  const std::vector<Place> way{{x0 - 0.1 * slope, 0.1}, {x0 + 0.1 * slope, -0.1}, {end, -0.1}};
  const auto height = [=](double s) { return wave * std::cos(8 * s + phase); };
  // It opens by up to `gap` round the material line s = x0 while the finger is near it, in the first half.
  const auto profile = [=](double s, double t) {
    const double open = gap * std::max(0.0, 1 - std::abs(t - 0.25) / 0.25);
    return Place(s + open * std::tanh((s - x0) / 0.05), height(s));
  };
  const auto finger = [=](double t) { return along(way, t); };
  const Motion motion{finger, profile, radius, draw(0.2, 0.5), static_cast<int>(std::ceil(0.45 / radius))};
  const Stage stage(motion, draw.random);
  // The material line at which the axis goes through: where its height above the sheet changes sign.
  double through = 0, best = 1;
  for (double t = 0; t < 0.5; t += 1e-4)
    for (double s = x0 - 0.1; s < x0 + 0.1; s += 2e-3) {
      const double apart = (profile(s, t) - finger(t)).norm();
      if (apart < best) best = apart, through = s;
    }
  ASSERT_LT(best, 3e-3);
  for (const bool elsewhere : {false, true}) {
    const Seen seen = watch(stage, motion.frames, elsewhere);
    EXPECT_GT(seen.contour_most_m, 0);
    const double low = std::min(through, end), high = std::max(through, end), near = 0.05;
    int inside = 0;
    for (std::size_t v = 0; v < stage.vertices(); ++v) {
      const Place at = stage.flat_place(v);
      if (std::abs(at[0] - low) < near || std::abs(at[0] - high) < near ||
          std::abs(std::abs(at[1]) - motion.half_length_m) < near)
        continue;  // beside the line the path of the frame decides
      const bool passed = at[0] > low && at[0] < high && std::abs(at[1]) < motion.half_length_m;
      EXPECT_EQ(seen.wrong[v], passed) << at.transpose() << " between " << low << " and " << high;
      EXPECT_FALSE(seen.laid_over[v]) << at.transpose();
      inside += passed;
    }
    EXPECT_GT(inside, 3);
  }
}

// Out beyond the rim, down and in below the sheet: it is laid over the finger.
void round_the_rim(Draw& draw) {
  const double radius = draw(0.01, 0.03), wave = draw(0, 0.02), phase = draw(0, 6), beat = draw(-20, 20);
  const double out = (draw(-1, 1) < 0 ? -1 : 1) * draw(0.8, 1), end = draw(-0.2, 0.2), depth = draw(0.06, 0.2);
  const std::vector<Place> way{{draw(-0.3, 0.3), 0.1}, {out, draw(0.05, 0.15)}, {out, -depth}, {end, -depth}};
  const auto profile = [=](double s, double t) { return Place(s, wave * std::cos(8 * s + phase + beat * t)); };
  // 10 to 100 mm a frame and more.
  const Motion motion{[=](double t) { return along(way, t); }, profile, radius, draw(0.2, 1),
                      static_cast<int>(draw(16, 40))};
  const Stage stage(motion, draw.random);
  for (const bool elsewhere : {false, true}) {
    const Seen seen = watch(stage, motion.frames, elsewhere);
    EXPECT_EQ(seen.contour_most_m, 0);
    EXPECT_EQ(seen.wrong_most, 0u) << (elsewhere ? "with" : "without") << " a contour elsewhere";
    EXPECT_GT(seen.laid_over_end, 5u);
  }
}

// The sheet's leading wall folds over the finger like a Z, away from any border.
void folded(Draw& draw) {
  const double bend = draw(0.05, 0.07), radius = draw(0.3, 0.8) * bend, flap = draw(0.15, 0.25);
  const double at = draw(-0.3, -0.1), height = draw(0, 0.1);
  // A turn by `angle` over a round edge at s = at, and back by the same angle over another, `flap` later.
  const auto profile = [=](double s, double t) {
    const double angle = std::numbers::pi * t, arc = bend * angle;
    const auto turned = [](double by, const Place& p) {
      return Place(std::cos(by) * p[0] - std::sin(by) * p[1], std::sin(by) * p[0] + std::cos(by) * p[1]);
    };
    const auto round = [&](double by) { return Place(bend * std::sin(by), bend * (1 - std::cos(by))); };
    const Place start(at, -height);
    if (s < at) return Place(s, -height);
    if (s < at + arc) return Place(start + round((s - at) / bend));
    const Place wall = start + round(angle), way = turned(angle, {1, 0});
    if (s < at + arc + flap) return Place(wall + (s - at - arc) * way);
    const Place top = wall + flap * way;
    const double by = std::min((s - at - arc - flap) / bend, angle);
    const Place back = top + turned(angle, Place(bend * std::sin(by), -bend * (1 - std::cos(by))));
    return Place(back + std::max(0.0, s - at - 2 * arc - flap) * Place(1, 0));
  };
  const Motion motion{[=](double) { return Place(at, bend - height); }, profile, radius, draw(0.15, 0.8),
                      static_cast<int>(draw(16, 30))};
  const Stage stage(motion, draw.random);
  for (const bool elsewhere : {false, true}) {
    const Seen seen = watch(stage, motion.frames, elsewhere);
    EXPECT_EQ(seen.contour_most_m, 0);
    EXPECT_EQ(seen.wrong_most, 0u) << (elsewhere ? "with" : "without") << " a contour elsewhere";
    EXPECT_GT(seen.laid_over_end, 5u);
  }
}

TEST(Passing, ThroughCounts) { for_every_seed(through); }
TEST(Passing, RoundTheRimDoesNot) { for_every_seed(round_the_rim); }
TEST(Passing, AFoldLaidOverDoesNot) { for_every_seed(folded); }

}  // namespace
}  // namespace clothbench::contact
