#include "xr/live_scene.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "assets/assets.hpp"
#include "base/files.hpp"
#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"
#include "render/camera.hpp"
#include "scenario/collider_reader.hpp"
#include "scenario/load.hpp"

namespace clothbench::xr {
namespace {

namespace fs = std::filesystem;
using assets::Side;
using nlohmann::json;

const std::vector<std::string> kScriptedAlone = {"expect", "truth", "stability", "seed"};

}  // namespace

LiveScene::LiveScene(const std::string& scenario, const std::vector<std::string>& overrides, fs::path folder,
                     bool live_hands)
    : folder_(std::move(folder)) {
  const fs::path source = find_scenario(scenario);
  written_ = load_scene(scenario, overrides);
  document_ = parse_json(read_text(source), source.string());
  for (const std::string& o : overrides) apply_override(document_, o, source.string());
  // These criteria hold for the scripted motion, not for the user's.
  for (const std::string& key : kScriptedAlone) document_.erase(key);
  document_["name"] = document_["name"].get<std::string>() + "-live";
  document_["why"] = "Recorded from a headset. " + document_["why"].get<std::string>();
  fs::create_directories(folder_);
  if (live_hands) find_live(source.string());
  keep_files(source.string());
}

void LiveScene::find_live(const std::string& source) {
  if (!document_.contains("colliders")) return;
  json& list = document_["colliders"];
  for (std::size_t k = 0; k < list.size(); ++k) {
    const auto type = list[k]["type"].get<std::string>();
    if (type != "hand_capsules" && type != "hand_mesh") continue;
    LiveHand hand;
    hand.collider = k;
    json track = list[k]["track"];
    if (track.is_string()) track = json_from(read_text(file_of_scene(track.get<std::string>(), source).value()));
    hand.side = track["hand"] == "left" ? Side::Left : Side::Right;
    hand.as_mesh = type == "hand_mesh";
    hand.file = std::string(assets::name_of(hand.side)) + "-hand.json";
    if (wants(hand.side))
      throw Error(
          fmt::format("{}: /colliders/{}: a second {} hand; a user has one", source, k, assets::name_of(hand.side)));
    hands_.push_back(std::move(hand));
    for (const char* key : {"track", "speed_m_per_s", "offset_m"}) list[k].erase(key);
  }
}

/// Stores the mesh file and the tracks of hands that stay scripted next to the scenario.
void LiveScene::keep_files(const std::string& source) {
  const auto keep = [&](json& owner, const char* key) {
    if (!owner.contains(key) || !owner[key].is_string()) return;
    const fs::path from = file_of_scene(owner[key].get<std::string>(), source).value();
    write_file_atomically(folder_ / from.filename(), read_text(from));
    owner[key] = from.filename().string();
  };
  if (document_["cloth"].contains("mesh")) keep(document_["cloth"]["mesh"], "file");
  for (const char* kind : {"colliders", "grips"})
    for (std::size_t k = 0; document_.contains(kind) && k < document_[kind].size(); ++k)
      keep(document_[kind][k], "track");
}

bool LiveScene::wants(Side side) const {
  return std::any_of(hands_.begin(), hands_.end(), [&](const LiveHand& h) { return h.side == side; });
}

Vec3 LiveScene::place_m() const {
  const render::Bounds cloth = render::Bounds::of(initial_positions(written_));
  return minus(kMiddle_m, scaled(0.5, plus(cloth.low, cloth.high)));
}

Vec3 LiveScene::put_on(json table) {
  json& pose = document_["cloth"]["pose"];
  const double drop_m = pose.contains("over_table") ? pose["over_table"]["drop_m"].get<double>() : 0.3;
  const Cloth& c = written_.cloth;
  pose.update({{"center_m", c.center_m}, {"axis_u", c.axis_u}, {"axis_v", c.axis_v}});
  pose.erase("over_table");
  const render::Bounds cloth = render::Bounds::of(initial_positions(written_));
  Vec3 center = scaled(0.5, plus(cloth.low, cloth.high));
  center[1] = cloth.low[1] - drop_m - table["size_m"][2].get<double>() / 2;
  const Vec3 by_m = minus(center, std::exchange(table["center_m"], center).get<Vec3>());
  json& list = document_["colliders"];
  for (std::size_t k = list.size(); k-- > 0;) {
    for (const char* key : {"margin_m", "friction"})
      if (list[k].contains(key)) table[key] = list[k][key];
    const auto type = list[k]["type"].get<std::string>();
    if (type.starts_with("hand_") || type == "capsule") continue;
    list.erase(k);
    for (LiveHand& h : hands_) h.collider -= h.collider > k ? 1 : 0;
  }
  list.push_back(table);
  document_.erase("assumed");  // it may point to what was removed
  return by_m;
}

const Scene& LiveScene::begin(const Begin& b) {
  if (!(b.frames >= 1 && b.frames <= kMostFrames))
    throw Error(fmt::format("a live session of {} frames: expected 1 to {}", b.frames, kMostFrames));
  document_["time"] = {{"frame_rate_hz", b.frame_rate_hz}, {"duration_s", b.frames / b.frame_rate_hz}};
  for (LiveHand& h : hands_) {
    const auto side = static_cast<std::size_t>(h.side);
    if (!b.hands[side]) throw Error(fmt::format("the {} hand is not tracked", assets::name_of(h.side)));
    h.recording = {h.side, b.frame_rate_hz, b.has_capsules, {*b.hands[side]}};
    if (h.as_mesh && !h.mesh) h.mesh = assets::open_hand(assets::locate_assets(false), h.side);
    write_hand(h);
    document_["colliders"][h.collider]["track"] = h.file;
  }
  scene_ = scene_from_json(document_, file());
  frames_ = 0;
  motion_.clear();
  if (!scene_.motion.empty()) motion_.push_back(scene_.motion.front());
  return scene_;
}

ColliderPose LiveScene::pose(const LiveHand& h, const assets::RecordedHand& now) const {
  const assets::Vector none = assets::Vector::Zero();
  return h.as_mesh ? mesh_pose(*h.mesh, assets::pose_of(now).joints, none)
                   : capsules_pose(assets::capsules(h.recording, now), none);
}

const FrameMotion* LiveScene::next(int index, const HandsNow& now) {
  ++frames_;
  const FrameMotion* scripted = scene_.motion_after(index);
  if (scripted == nullptr) return nullptr;
  FrameMotion m = *scripted;
  for (LiveHand& h : hands_) {
    const auto& seen = now[static_cast<std::size_t>(h.side)];
    h.recording.frames.push_back(seen ? *seen : h.recording.frames.back());
    m.colliders.at(h.collider) = pose(h, h.recording.frames.back());
  }
  motion_.push_back(std::move(m));
  return &motion_.back();
}

void LiveScene::write_hand(const LiveHand& h) const {
  const char* capsules = h.recording.has_capsules ? "XR_FB_hand_tracking_capsules" : "XR_EXT_hand_tracking's joints";
  write_file_atomically(
      folder_ / h.file,
      assets::to_json(h.recording, fmt::format("The {} hand of a live session. Capsules come from {}.",
                                               assets::name_of(h.side), capsules)));
}

fs::path LiveScene::save() {
  for (const LiveHand& h : hands_) write_hand(h);
  document_["time"]["duration_s"] = std::max(frames_, 1) / scene_.time.frame_rate_hz;
  write_file_atomically(file(), dump(document_, 1) + "\n");
  return file();
}

}  // namespace clothbench::xr
