#include "scenario/collider_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/json_text.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"

namespace clothbench {

void ColliderReader::enter(std::string at) {
  at_ = std::move(at);
  pose = nullptr;
  table.reset();
}

void ColliderReader::complete(nlohmann::json& j, const std::string& definition) const {
  const nlohmann::json schema = json_from(kSceneSchema);
  nlohmann::json sub = schema["definitions"][definition];
  sub["definitions"] = schema["definitions"];
  validate_json(j, dump(sub), source_, at_);
  fill_defaults(j, dump(sub));
}

void ColliderReader::refuse(const std::string& key, const std::string& expected) const {
  throw Error(source_ + ": " + at_ + key + ": " + expected);
}

Vec3 ColliderReader::unit(const nlohmann::json& j, const std::string& key) const {
  constexpr double kUnit = 1e-9;  // tolerance for the squared length
  const Vec3 v = vec3(j[key]);
  if (!(std::abs(dot(v, v) - 1) <= kUnit)) refuse("/" + key, "expected a vector of length 1");
  return v;
}

Path ColliderReader::path(const nlohmann::json& j) const {
  Path p;
  p.velocity_m_per_s = vec3(j.at("velocity_m_per_s"));
  p.ramp_s = j.value("ramp_s", 0.0);
  p.start_s = j.value("start_s", 0.0);
  if (j.contains("stop_s")) p.stop_s = j["stop_s"].get<double>();
  if (j.contains("release_s")) p.release_s = j["release_s"].get<double>();
  if (j.contains("jumps"))
    for (const auto& at : j["jumps"]) p.jumps.push_back({at["time_s"].get<double>(), vec3(at["by_m"])});
  for (const Path::At& jump : p.jumps) {
    int frame = 1;
    while (frame <= scene_.time.frames() && !(scene_.time.at(frame) > jump.time_s)) ++frame;
    if (frame <= scene_.time.frames()) scene_.jumps.push_back({frame, length(jump.by_m)});
  }
  return p;
}

const assets::AssetSource& ColliderReader::assets() {
  if (!assets_) {
    assets_ = assets::locate_assets(wanted_ == Assets::Required);
    scene_.assets = assets_->kind();
  }
  return *assets_;
}

namespace {

/// Time [s] in which full speed from the start gives the displacement that the ramp gives in `t`.
double ramped(double t, double ramp_s) {
  if (t >= ramp_s) return t - ramp_s / 2;
  return t / 2 - ramp_s / (2 * std::numbers::pi) * std::sin(std::numbers::pi * t / ramp_s);
}

ColliderPose pose_at(const MovingHand& m, bool as_mesh, double time_s) {
  if (m.recording) {
    const assets::RecordedHand& now = m.recording->at(time_s);
    return as_mesh ? mesh_pose(*m.hand, assets::pose_of(now).joints, m.offset_m)
                   : capsules_pose(assets::capsules(*m.recording, now), m.offset_m);
  }
  const assets::HandSample now = assets::sample(m.track, *m.hand, time_s);
  return as_mesh ? mesh_pose(*m.hand, now.pose.joints, m.offset_m)
                 : capsules_pose(assets::capsules(now.pose), m.offset_m);
}

/// Refuses a radius of 0, which a runtime reports for an unknown radius. The error points to the capsules or joints.
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

/// Reads a track or a recording from its own file.
MovingHand hand_of_file(const nlohmann::json& j, ColliderReader& reader, bool as_mesh) {
  const auto name = j["track"].get<std::string>();
  const std::filesystem::path file = needed_file(name, reader.source(), reader.pointer() + "/track");
  const std::string text = read_text(file);
  if (!assets::is_hand_recording(parse_json(text, file.string())))
    return {{}, assets::parse_hand_track(text, file.string()), {}};
  if (j.contains("speed_m_per_s"))
    reader.refuse("/speed_m_per_s", "expected no speed for a recording, which is replayed at its own speed");
  MovingHand m{{}, {}, assets::parse_hand_recording(text, file.string())};
  if (!as_mesh) require_radii(*m.recording, file.string());
  if (as_mesh) m.hand = assets::open_hand(reader.assets(), m.recording->side);
  return m;
}

}  // namespace

Vec3 Path::displacement(double time_s) const {
  const double until = stop_s ? std::min(time_s, *stop_s) : time_s;
  const double seconds = ramped(std::max(0.0, until - start_s), ramp_s);
  Vec3 out = scaled(seconds, velocity_m_per_s);
  for (const At& jump : jumps)
    if (time_s > jump.time_s) out = plus(out, jump.by_m);
  return out;
}

MovingHand moving_hand(const nlohmann::json& j, ColliderReader& reader, bool as_mesh) {
  const nlohmann::json& track = j["track"];
  MovingHand m = track.is_object() ? MovingHand{{}, assets::parse_hand_track(dump(track), reader.where("/track")), {}}
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

std::optional<std::filesystem::path> file_of_scene(const std::string& name, const std::string& source) {
  std::error_code ec;
  const std::filesystem::path beside = std::filesystem::path(source).parent_path() / name;
  if (std::filesystem::is_regular_file(beside, ec)) return beside;
  const std::filesystem::path named = scenario_root() / name;
  if (std::filesystem::is_regular_file(named, ec)) return named;
  return std::nullopt;
}

std::filesystem::path needed_file(const std::string& name, const std::string& source, const std::string& pointer) {
  if (const auto found = file_of_scene(name, source)) return *found;
  refuse(source, pointer,
         fmt::format("{}: no such file next to the scene or in {}", in_quotes(name), scenario_root().string()));
}

std::shared_ptr<ColliderMesh> collider_mesh(const assets::TriangleMesh& from) {
  auto mesh = std::make_shared<ColliderMesh>();
  mesh->positions = from.positions;
  mesh->triangles = from.triangles;
  // A room's mesh can also be closed, but its solid is outside, so penetration depth is not defined.
  mesh->closed = assets::is_closed_manifold(from) && assets::signed_volume(from) > 0;
  return mesh;
}

std::shared_ptr<ColliderMesh> collider_mesh(const assets::SkinnedMesh& from) {
  auto mesh = collider_mesh(from.rest);
  mesh->joints = from.joints;
  for (const auto& w : from.weights)
    mesh->weights.push_back(
        {static_cast<float>(w[0]), static_cast<float>(w[1]), static_cast<float>(w[2]), static_cast<float>(w[3])});
  mesh->joint_count = assets::kJointCount;
  return mesh;
}

ColliderPose capsules_pose(const std::array<assets::Capsule, assets::kCapsuleCount>& capsules,
                           const assets::Vector& offset_m) {
  ColliderPose pose;
  for (const assets::Capsule& c : capsules)
    pose.capsules.push_back({to_vec3(c.a + offset_m), to_vec3(c.b + offset_m), c.radius_m});
  return pose;
}

ColliderPose mesh_pose(const assets::Hand& hand, const assets::JointFrames& joints, const assets::Vector& offset_m) {
  ColliderPose pose;
  for (std::size_t k = 0; k < assets::kJointCount; ++k) {
    const Eigen::Affine3d m = Eigen::Translation3d(offset_m) * (joints[k] * hand.mesh.inverse_bind[k]);
    Affine& to = pose.joints.emplace_back();
    for (int row = 0; row < 3; ++row)
      Eigen::RowVector4d::Map(to[static_cast<std::size_t>(row)].data()) = m.matrix().row(row);
  }
  return pose;
}

}  // namespace clothbench
