#pragma once
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "assets/hand_track.hpp"
#include "clothbench/scene.hpp"
#include "xr/loop.hpp"

namespace clothbench::xr {

/// Left and right hand; empty if not tracked.
using HandsNow = std::array<std::optional<assets::RecordedHand>, 2>;

/// A scenario whose hands come from a headset. The user's hands replace the scripted hands of the same side. All other
/// motion stays scripted.
///
/// Live data are first written and then read back: `folder` has scenario and recordings in the formats of ordinary
/// scenes, so that `clothbench run FOLDER/scenario.json` runs the same frames from the same numbers.
class LiveScene {
 public:
  /// Throws Error like load_scene, and if the scene has two hands of the same side. `live_hands`: whether the headset
  /// tracks hands.
  LiveScene(const std::string& scenario, const std::vector<std::string>& overrides, std::filesystem::path folder,
            bool live_hands);

  /// The scenario as written, with cloth and time before live parts replace them.
  const Scene& written() const { return written_; }
  bool wants(assets::Side) const;
  /// The scene's origin in the user's space [m]: the initial cloth's middle is 60 cm in front of the eyes and 10 cm
  /// below.
  Vec3 place_m() const;
  static constexpr Vec3 kMiddle_m = {0, -0.1, -0.6};  ///< centre of the initial cloth in the user's space

  /// Puts the user's table (a box as a scene's file has it) under the middle of the cloth instead of all static
  /// colliders, as far below the cloth as the scene's own table, otherwise 0.3 m. Returns the displacement of the box.
  Vec3 put_on(nlohmann::json table);

  struct Begin {
    double frame_rate_hz = 0;
    int frames = 0;  ///< length of the session; 1 to kMostFrames
    HandsNow hands;
    bool has_capsules = false;
  };
  /// Builds the scene from the headset's current state; may be repeated. Throws Error if a required hand is missing.
  const Scene& begin(const Begin&);
  const Scene& scene() const { return scene_; }

  /// Poses at the end of frame `index` (0 = the first); a hand that is not tracked keeps its last pose. Null if nothing
  /// moves. Valid until the next call.
  const FrameMotion* next(int index, const HandsNow&);
  /// The motion of every frame so far, including the start.
  const std::vector<FrameMotion>& motion() const { return motion_; }
  /// Writes the recordings, and the scenario with their number of frames. Returns the path of the scenario.
  std::filesystem::path save();

 private:
  struct LiveHand {
    std::size_t collider = 0;
    assets::Side side = assets::Side::Right;
    bool as_mesh = false;
    std::string file;
    assets::HandRecording recording;
    std::optional<assets::Hand> mesh;  ///< only if `as_mesh`
  };
  void find_live(const std::string& source);
  void keep_files(const std::string& source);
  void write_hand(const LiveHand&) const;
  ColliderPose pose(const LiveHand&, const assets::RecordedHand&) const;
  std::string file() const { return (folder_ / "scenario.json").string(); }

  std::filesystem::path folder_;
  nlohmann::json document_;
  Scene written_, scene_;
  std::vector<LiveHand> hands_;
  std::vector<FrameMotion> motion_;
  int frames_ = 0;
};

}  // namespace clothbench::xr
