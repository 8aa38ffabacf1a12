#include "assets/hand_track.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "assets/json_at.hpp"
#include "base/json_text.hpp"
#include "clothbench/error.hpp"

namespace clothbench::assets {
namespace {

constexpr double kMostMetres = 1e4, kMostSeconds = 86400;

void read_pose(const JsonAt& at, HandKey& key, bool first) {
  const std::vector<std::string> known(kPoseNames.begin(), kPoseNames.end());
  const auto pose = at.maybe("pose"), blend = at.maybe("blend");
  if (!pose && first) at.fail("\"pose\" is missing; the first key must have one");
  if (!pose && blend) blend->fail("expected \"pose\" next to it");
  if (!pose) return;
  key.pose = pose->word(known);
  key.blend_to.clear();
  key.amount = 0;
  if (!blend) return;
  blend->only({"to", "amount"});
  key.blend_to = blend->key("to").word(known);
  const JsonAt amount = blend->key("amount");
  key.amount = amount.number();
  if (!(key.amount >= 0 && key.amount <= 1)) amount.fail("expected 0 to 1, not " + amount.json().dump());
}

HandKey read_key(const JsonAt& at, const HandKey* before) {
  at.only({"time_s", "pose", "blend", "position_m", "rotation_deg", "grip", "sweep"});
  HandKey key = before ? *before : HandKey{};
  const JsonAt time = at.key("time_s");
  key.time_s = time.number();
  if (!(key.time_s >= 0 && key.time_s <= kMostSeconds)) time.fail(fmt::format("expected 0 to {} s", kMostSeconds));
  if (before && !(key.time_s > before->time_s))
    time.fail(fmt::format("expected later than the key before, {} s", before->time_s));
  read_pose(at, key, before == nullptr);
  const JsonAt position = at.key("position_m");
  key.position_m = position.numbers(3);
  if (!(key.position_m.cwiseAbs().maxCoeff() <= kMostMetres))
    position.fail(fmt::format("expected at most {} m", kMostMetres));
  if (const auto degrees = at.maybe("rotation_deg")) key.orientation = from_degrees(degrees->numbers(3));
  const auto grip = at.maybe("grip");
  key.grip = grip && grip->boolean();
  const auto sweep = at.maybe("sweep");
  key.sweep = sweep && sweep->boolean();
  return key;
}

HandPose pose_of(const HandKey& key, const Hand& hand) {
  const HandPose& pose = hand.pose(key.pose);
  return key.blend_to.empty() ? pose : blended(pose, hand.pose(key.blend_to), key.amount);
}

}  // namespace

Eigen::Quaterniond from_degrees(const Vector& degrees) {
  const Vector r = degrees * (std::numbers::pi / 180);
  using Turn = Eigen::AngleAxisd;
  return Eigen::Quaterniond(Turn(r.z(), Vector::UnitZ()) * Turn(r.y(), Vector::UnitY()) * Turn(r.x(), Vector::UnitX()));
}

HandTrack parse_hand_track(const std::string& text, const std::string& source) {
  const nlohmann::json document = parse_json(text, source);
  const JsonAt root(document, source);
  root.only({"hand", "anchor", "why", "keys"});
  HandTrack track;
  track.side = root.key("hand").word({"left", "right"}) == "left" ? Side::Left : Side::Right;
  if (const auto anchor = root.maybe("anchor"))
    track.anchor = anchor->word({"palm", "pinch"}) == "pinch" ? Anchor::Pinch : Anchor::Palm;
  if (const auto why = root.maybe("why")) why->text();
  const JsonAt keys = root.key("keys");
  if (keys.size() == 0) keys.fail("expected at least one key");
  for (std::size_t i = 0; i < keys.size(); ++i) {
    HandKey key = read_key(keys.item(i), track.keys.empty() ? nullptr : &track.keys.back());
    track.keys.push_back(std::move(key));
  }
  return track;
}

HandTrack read_hand_track(const std::filesystem::path& path) {
  return parse_hand_track(read_text(path), path.string());
}

HandTrack retimed(HandTrack track, double speed_m_per_s) {
  if (!(speed_m_per_s > 0)) throw Error(fmt::format("hand track: expected a speed above 0, not {} m/s", speed_m_per_s));
  double shift_s = 0;
  bool any = false;
  for (std::size_t i = 0; i + 1 < track.keys.size(); ++i) {
    const HandKey& key = track.keys[i];
    const double before_s = track.keys[i + 1].time_s - (key.time_s - shift_s),
                 distance_m = (track.keys[i + 1].position_m - key.position_m).norm();
    if (key.sweep && !(distance_m > 0))
      throw Error(fmt::format("hand track: key {} is a sweep, but the next key is in the same place", i));
    const double takes_s = key.sweep ? distance_m / speed_m_per_s : before_s;
    any = any || key.sweep;
    shift_s += takes_s - before_s;
    track.keys[i + 1].time_s += shift_s;
  }
  if (!any) throw Error("hand track: expected a key with \"sweep\", whose speed can be changed");
  if (!(track.duration_s() <= kMostSeconds))
    throw Error(fmt::format("hand track: at {} m/s it takes {} s: expected at most {}", speed_m_per_s,
                            track.duration_s(), kMostSeconds));
  return track;
}

HandSample sample(const HandTrack& track, const Hand& hand, double time_s) {
  if (track.side != hand.side)
    throw Error(fmt::format("hand track: it is of the {} hand: expected one of the {} hand", name_of(track.side),
                            name_of(hand.side)));
  if (!std::isfinite(time_s)) throw Error("hand track: argument time_s: expected a finite time");
  std::size_t next = 0;
  while (next < track.keys.size() && track.keys[next].time_s <= time_s) ++next;
  const HandKey& a = track.keys[next == 0 ? 0 : next - 1];
  const HandKey& b = track.keys[std::min(next, track.keys.size() - 1)];
  const double t = b.time_s > a.time_s ? (time_s - a.time_s) / (b.time_s - a.time_s) : 0;

  HandSample out;
  out.grip = next > 0 && a.grip;
  const bool same = a.pose == b.pose && a.blend_to == b.blend_to && a.amount == b.amount;
  out.pose = same ? pose_of(a, hand) : blended(pose_of(a, hand), pose_of(b, hand), t);
  Frame place = Frame::Identity();
  place.linear() = a.orientation.slerp(t, b.orientation).normalized().toRotationMatrix();
  place.translation() = (1 - t) * a.position_m + t * b.position_m;
  if (track.anchor == Anchor::Pinch) place.translate(-pinch_point(out.pose));
  out.pose = moved(out.pose, place);
  return out;
}

}  // namespace clothbench::assets
