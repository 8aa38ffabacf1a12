#include "scenario/moving_hand.hpp"

#include <fmt/format.h>

#include "base/json_text.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "scenario/vec3.hpp"

namespace clothbench {
namespace {

ColliderPose pose_at(const MovingHand& m, bool as_mesh, double time_s) {
  if (m.recording) {
    const assets::RecordedHand& now = m.recording->at(time_s);
    return as_mesh ? mesh_pose(*m.hand, assets::pose_of(now).joints, m.offset_m)
                   : capsules_pose(*m.recording, now, m.offset_m);
  }
  const assets::HandSample now = assets::sample(m.track, *m.hand, time_s);
  if (as_mesh) return mesh_pose(*m.hand, now.pose.joints, m.offset_m);
  ColliderPose pose;
  for (const assets::Capsule& c : assets::capsules(now.pose))
    pose.capsules.push_back(
        {to_vec3(assets::Vector(c.a + m.offset_m)), to_vec3(assets::Vector(c.b + m.offset_m)), c.radius_m});
  return pose;
}

/// A runtime that does not know a radius reports 0. The pointer leads to the block that the capsules come from.
void require_radii(const assets::HandRecording& recording, const std::string& file) {
  for (std::size_t f = 0; f < recording.frames.size(); ++f) {
    const auto capsules = assets::capsules(recording, recording.frames[f]);
    for (std::size_t k = 0; k < capsules.size(); ++k)
      if (!(capsules[k].radius_m > 0))
        refuse(file, recording.has_capsules ? "/recording/capsules" : "/recording/joints",
               fmt::format("frame {}: capsule {} of {} has a radius of {} m; expected more than 0, or type hand_mesh, "
                           "which needs no radii",
                           f, k, capsules.size(), capsules[k].radius_m));
  }
}

/// A track or a recording in a file of its own.
MovingHand hand_of_file(const nlohmann::json& j, ColliderReader& reader, bool as_mesh) {
  const auto name = j["track"].get<std::string>();
  const auto file = file_of_scene(name, reader.source());
  if (!file)
    reader.refuse("/track",
                  fmt::format("{}: no such file beside the scene or in {}", in_quotes(name), scenario_root().string()));
  const std::string text = read_text(*file);
  if (!assets::is_hand_recording(parse_json(text, file->string())))
    return {{}, assets::parse_hand_track(text, file->string()), {}};
  if (j.contains("speed_m_per_s"))
    reader.refuse("/speed_m_per_s", "expected no speed for a recording, which is replayed at its own speed");
  MovingHand m{{}, {}, assets::parse_hand_recording(text, file->string())};
  if (!as_mesh) require_radii(*m.recording, file->string());
  if (as_mesh) m.hand = assets::open_hand(reader.assets(), m.recording->side);
  return m;
}

}  // namespace

MovingHand moving_hand(const nlohmann::json& j, ColliderReader& reader, bool as_mesh) {
  const nlohmann::json& track = j["track"];
  MovingHand m = track.is_object() ? MovingHand{{}, assets::parse_hand_track(track.dump(), reader.where("/track")), {}}
                                   : hand_of_file(j, reader, as_mesh);
  if (m.recording) return m;
  if (j.contains("speed_m_per_s")) {
    try {
      m.track = assets::retimed(std::move(m.track), j["speed_m_per_s"].get<double>());
    } catch (const Error& e) {
      reader.refuse("/speed_m_per_s", e.what());
    }
  }
  m.hand = assets::open_hand(reader.assets(), m.track.side);
  return m;
}

void read_hand(const nlohmann::json& j, ColliderReader& reader, Collider& c, bool as_mesh) {
  MovingHand m = moving_hand(j, reader, as_mesh);
  if (j.contains("offset_m")) m.offset_m = assets::Vector::Map(vec3(j["offset_m"]).data());
  c.name = j["track"].is_object() ? std::string(assets::name_of(m.track.side)) + "-hand"
                                  : std::filesystem::path(j["track"].get<std::string>()).stem().string();
  c.shape = as_mesh ? Collider::Shape::Mesh : Collider::Shape::Capsules;
  if (as_mesh) c.mesh = collider_mesh(m.hand->mesh);
  c.recorded = m.recording.has_value();
  reader.pose = [m = std::move(m), as_mesh](double time_s) { return pose_at(m, as_mesh, time_s); };
  if (!as_mesh) c.capsules = reader.pose(0).capsules;
}

}  // namespace clothbench
