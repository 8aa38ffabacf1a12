#pragma once
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "assets/hand_recording.hpp"
#include "assets/room.hpp"
#include "clothbench/scene.hpp"
#include "xr/loop.hpp"

namespace clothbench::xr {

/// What a headset can put in a scenario's place.
struct Live {
  bool hands = false, room = false;
};

/// Left and right, as far as they are seen.
using HandsNow = std::array<std::optional<assets::RecordedHand>, 2>;

/// A scenario whose hands and room come from a headset. Its scripted hands are replaced by the user's, each by the one
/// of its side, and the room by the user's with the part between six picked points; whatever else moves goes on by
/// script.
///
/// What is used is written first and read back: scenario, recordings and room lie in `folder` as ordinary scenes have
/// them, so that `clothbench run FOLDER/scenario.json` runs the same frames from the same numbers.
class LiveScene {
 public:
  /// Throws Error as load_scene, and where the scene has two hands of a side, or two rooms.
  LiveScene(const std::string& scenario, const std::vector<std::string>& overrides, std::filesystem::path folder,
            Live live);

  /// The scenario as it is written: cloth and time before anything is live.
  const Scene& written() const { return written_; }
  bool wants(assets::Side) const;
  bool wants_room() const { return room_.has_value(); }

  struct Begin {
    double frame_rate_hz = 0;
    int frames = 0;  ///< of the session; 1 to kMostFrames
    HandsNow hands;
    bool has_capsules = false;
    std::array<std::optional<assets::RecordedMesh>, 2> meshes;
    std::optional<assets::RoomScan> room;
    std::vector<Vec3> picked_m;  ///< six, with a room
  };
  /// Makes the scene at this instant, anew if called again. Throws Error if a hand it wants is missing.
  const Scene& begin(const Begin&);
  const Scene& scene() const { return scene_; }

  /// Where everything is at the end of frame `index` (0 = the first); what is not seen stays where it was. Null where
  /// nothing moves. Valid until the next call.
  const FrameMotion* next(int index, const HandsNow&);
  /// Of every frame so far, the start included.
  const std::vector<FrameMotion>& motion() const { return motion_; }
  /// Writes the recordings and the scenario of as many frames. Returns the scenario's file.
  std::filesystem::path save();

 private:
  struct LiveHand {
    std::size_t collider = 0;
    assets::Side side = assets::Side::Right;
    bool as_mesh = false;
    std::string file;
    assets::HandRecording recording;
    std::optional<assets::Hand> stand_in;  ///< moved where the runtime has no mesh
  };
  void find_live(const std::string& source, Live live);
  void keep_tracks(const std::string& source);
  void write_hand(const LiveHand&) const;
  ColliderPose pose(const LiveHand&, const assets::RecordedHand&) const;
  std::string file() const { return (folder_ / "scenario.json").string(); }

  std::filesystem::path folder_;
  nlohmann::json document_;
  Scene written_, scene_;
  std::vector<LiveHand> hands_;
  std::optional<std::size_t> room_;  ///< the collider
  std::vector<FrameMotion> motion_;
  int frames_ = 0;
};

}  // namespace clothbench::xr
