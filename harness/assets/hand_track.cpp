#include "assets/hand_track.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/json_text.hpp"
#include "clothbench/error.hpp"

namespace clothbench::assets {
namespace {

constexpr double kMostSeconds = 86400;

constexpr char kTrackSchema[] = R"({
  "definitions": {
    "pose": {"enum": ["relaxed", "pinch", "point"]},
    "place": {"type": "array", "minItems": 3, "maxItems": 3,
              "items": {"type": "number", "minimum": -1e4, "maximum": 1e4}}
  },
  "type": "object", "required": ["hand", "keys"], "additionalProperties": false, "properties": {
    "hand": {"enum": ["left", "right"]},
    "anchor": {"enum": ["palm", "pinch"]},
    "why": {"type": "string"},
    "keys": {"type": "array", "minItems": 1, "items": {
      "type": "object", "required": ["time_s", "position_m"], "additionalProperties": false, "properties": {
        "time_s": {"type": "number", "minimum": 0, "maximum": 86400},
        "pose": {"$ref": "#/definitions/pose"},
        "blend": {"type": "object", "required": ["to", "amount"], "additionalProperties": false, "properties": {
          "to": {"$ref": "#/definitions/pose"},
          "amount": {"type": "number", "minimum": 0, "maximum": 1}}},
        "position_m": {"$ref": "#/definitions/place"},
        "rotation_deg": {"$ref": "#/definitions/place"},
        "grip": {"type": "boolean"},
        "sweep": {"type": "boolean"}}}}
  }
})";

Vector vector_of(const nlohmann::json& j) { return {j[0].get<double>(), j[1].get<double>(), j[2].get<double>()}; }

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
  validate_json(document, kTrackSchema, source);
  HandTrack track;
  track.side = document["hand"] == "left" ? Side::Left : Side::Right;
  track.anchor = document.value("anchor", "palm") == "pinch" ? Anchor::Pinch : Anchor::Palm;
  for (const nlohmann::json& j : document["keys"]) {
    const std::string pointer = fmt::format("/keys/{}", track.keys.size());
    const bool first = track.keys.empty();
    HandKey key = first ? HandKey{} : track.keys.back();
    const double before_s = key.time_s;
    key.time_s = j["time_s"].get<double>();
    if (!first && !(key.time_s > before_s))
      refuse(source, pointer + "/time_s", fmt::format("expected later than the key before, {} s", before_s));
    if (j.contains("pose")) {
      const nlohmann::json blend = j.value("blend", nlohmann::json::object());
      key.pose = j["pose"].get<std::string>();
      key.blend_to = blend.value("to", "");
      key.amount = blend.value("amount", 0.0);
    } else if (first || j.contains("blend")) {
      refuse(source, pointer, "\"pose\" is missing; the first key, and one with \"blend\", must have one");
    }
    key.position_m = vector_of(j["position_m"]);
    if (j.contains("rotation_deg")) key.orientation = from_degrees(vector_of(j["rotation_deg"]));
    key.grip = j.value("grip", false);
    key.sweep = j.value("sweep", false);
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
