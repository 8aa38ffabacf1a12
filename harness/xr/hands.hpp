#pragma once
#include <array>
#include <optional>

#include "assets/hand_recording.hpp"
#include "xr/session.hpp"

namespace clothbench::xr {

/// The hands that the runtime tracks (XR_EXT_hand_tracking), with its capsules and meshes where it has them.
class Hands {
 public:
  explicit Hands(const Session&);
  ~Hands();
  Hands(const Hands&) = delete;
  Hands& operator=(const Hands&) = delete;

  /// In the scene's space; empty unless every joint is known.
  std::optional<assets::RecordedHand> at(assets::Side, XrTime) const;
  bool has_capsules() const { return capsules_; }
  /// XR_FB_hand_tracking_mesh; empty where the runtime has none. Throws Error where it makes no sense.
  std::optional<assets::RecordedMesh> mesh(assets::Side) const;

 private:
  const Session& session_;
  bool capsules_ = false;
  PFN_xrLocateHandJointsEXT locate_ = nullptr;
  std::array<XrHandTrackerEXT, 2> trackers_{};
};

}  // namespace clothbench::xr
