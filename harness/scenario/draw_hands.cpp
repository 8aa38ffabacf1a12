// Hands of random scenes: keys of a track, for a cloth of 1 m that hangs in z = 0 with its middle at the origin.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "assets/hand.hpp"
#include "scenario/draw_contact.hpp"

namespace clothbench {
namespace {

using nlohmann::json;
using std::numbers::pi;

constexpr double kSettle_s = 0.5, kApproach_s = 0.4, kAway_s = 1;
constexpr double kAway_m = 0.35;  ///< distance from palm to cloth at which no finger touches, in any orientation
constexpr double kFrameRate_hz = 72, kSpeedOfLongestFrames_m_per_s = 5;

/// Builds the keys of a track one after another.
class Track {
 public:
  Track(std::string side, std::string why) : j_{{"hand", side}, {"why", why}, {"keys", json::array()}} {}
  json& go(double takes_s, const Vec3& to) {
    time_s_ += takes_s;
    j_["keys"].push_back({{"time_s", rounded(time_s_)}, {"position_m", rounded(to)}});
    return j_["keys"].back();
  }
  double end_s() const { return rounded(time_s_); }
  json& object() { return j_; }

 private:
  json j_;
  double time_s_ = 0;
};

void set_time(json& scene, double end_s, double speed_m_per_s) {
  const double rate = kFrameRate_hz * std::max(1.0, std::ceil(speed_m_per_s / kSpeedOfLongestFrames_m_per_s));
  scene["time"] = {{"frame_rate_hz", rate}, {"duration_s", rounded(std::ceil(end_s * rate - 1e-6) / rate)}};
}

/// Samples left or right hand, a blend of two poses, and any orientation.
void draw_pose(json& first_key, json& track, DrawnValues& draw) {
  const auto pose = [&] { return std::string(assets::kPoseNames[static_cast<std::size_t>(draw.dice().whole(0, 2))]); };
  track["hand"] = draw.dice().whole(0, 1) == 0 ? "left" : "right";
  const std::string from = pose(), to = pose();
  const double amount = draw.between("pose_blend");
  first_key["pose"] = from;
  first_key["blend"] = {{"to", to}, {"amount", amount}};
  first_key["rotation_deg"] = rounded(euler_deg(draw.dice().rotation()));
  draw.note("hand", track["hand"]);
  draw.note("pose", from);
  draw.note("pose_blended_to", to);
  for (std::size_t k = 0; k < 3; ++k)
    draw.note(std::string("hand_about_") + "xyz"[k] + "_deg", first_key["rotation_deg"][k]);
}

}  // namespace

double draw_sweep(json& scene, DrawnValues& draw) {
  const double speed = draw.log_between("speed_m_per_s");
  const double angle = draw.between("direction_deg") * pi / 180, side = draw.dice().whole(0, 1) == 0 ? -1 : 1;
  const double half = draw.between("way_m") / 2, x = draw.between("across_m"), y = draw.between("above_middle_m");
  const double in = draw.between("depth_m", "depth_in_m"), out = draw.between("depth_m", "depth_out_m");
  draw.note("from_side_z", side);
  const Vec3 d = {half * std::cos(angle), half * std::sin(angle), 0};
  const Vec3 from = {x - d[0], y - d[1], -side * in}, to = {x + d[0], y + d[1], -side * out};
  const auto away = [&](const Vec3& p) { return Vec3{p[0], p[1], side * kAway_m}; };
  Track t("right", "Drawn: approaches, goes through where the cloth hangs, leaves.");
  draw_pose(t.go(0, away(from)), t.object(), draw);
  t.go(kSettle_s, away(from));
  t.go(kApproach_s, from)["sweep"] = true;
  t.go(std::hypot(2 * half, out - in) / speed, to);
  t.go(kApproach_s, away(to));
  t.go(kAway_s, away(to));
  scene["colliders"][0]["track"] = t.object();
  set_time(scene, t.end_s(), speed);
  return speed;
}

double draw_push(json& scene, DrawnValues& draw) {
  const double lean = draw.between("lean_deg") * pi / 180, towards = draw.between("direction_deg") * pi / 180;
  const double side = draw.dice().whole(0, 1) == 0 ? -1 : 1;
  const double x = draw.between("across_m"), y = draw.between("above_middle_m"), depth = draw.between("depth_m");
  const double push_s = draw.log_between("push_s"), hold_s = draw.between("hold_s");
  draw.note("from_side_z", side);
  const double sideways = std::tan(lean);
  const auto at = [&](double past_m) {
    return Vec3{x + past_m * sideways * std::cos(towards), y + past_m * sideways * std::sin(towards), -side * past_m};
  };
  Track t("right", "Drawn: pushes the cloth out of its plane, holds, withdraws the same way.");
  draw_pose(t.go(0, at(-kAway_m)), t.object(), draw);
  t.go(kSettle_s, at(-kAway_m))["sweep"] = true;
  t.go(push_s, at(depth));
  t.go(hold_s, at(depth));
  t.go(kApproach_s, at(-kAway_m));
  t.go(kAway_s, at(-kAway_m));
  scene["colliders"][0]["track"] = t.object();
  const double way = (kAway_m + depth) / std::cos(lean), back = way / kApproach_s;
  set_time(scene, t.end_s(), std::max(way / push_s, back));
  return way / push_s;
}

double draw_stretch(json& scene, DrawnValues& draw) {
  constexpr double kHalfWidth_m = 0.5, kHold_s = 0.5, kOpen_s = 0.1;
  const double speed = draw.log_between("speed_m_per_s"), way = draw.between("way_m");
  const int cells = scene["cloth"]["grid"][0].get<int>() - 1;
  scene["grips"] = json::array();
  for (const double side : {-1.0, 1.0}) {
    const double y = draw.between("above_middle_m", side < 0 ? "left_above_middle_m" : "right_above_middle_m");
    const Vec3 here = {side * kHalfWidth_m, y, 0}, there = {side * (kHalfWidth_m + way), y, 0};
    Track t(side < 0 ? "left" : "right", "Drawn: pinches an edge, pulls outwards, holds, lets go.");
    t.object()["anchor"] = "pinch";
    json& first = t.go(0, here);
    first["pose"] = "pinch";
    first["rotation_deg"] = {-90, side * 37.7, -side * 90};
    first["grip"] = true;
    json& pull = t.go(kSettle_s, here);
    pull["grip"] = pull["sweep"] = true;
    t.go(way / speed, there)["grip"] = true;
    t.go(kHold_s, there);
    t.go(kOpen_s, there)["pose"] = "relaxed";
    t.go(kAway_s, there);
    // With a radius above half a cell, the hand grips at least one vertex anywhere along the edge.
    scene["grips"].push_back({{"track", t.object()}, {"radius_m", rounded(0.55 * 2 * kHalfWidth_m / cells)}});
    set_time(scene, t.end_s(), speed);
  }
  return speed;
}

}  // namespace clothbench
