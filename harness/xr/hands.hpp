#pragma once
#include <array>
#include <optional>

#include "assets/hand_recording.hpp"
#include "xr/session.hpp"

namespace clothbench::xr {

/// Hands tracked by the runtime (XR_EXT_hand_tracking), with its capsules and meshes if it provides them.
class Hands {
 public:
  explicit Hands(const Session&);
  ~Hands();
  Hands(const Hands&) = delete;
  Hands& operator=(const Hands&) = delete;

  /// The hand in the scene's space; empty unless every joint is known.
  std::optional<assets::RecordedHand> at(assets::Side, XrTime) const;
  bool has_capsules() const { return capsules_; }
  /// XR_FB_hand_tracking_mesh; empty if the runtime does not have it. Throws Error if the mesh is invalid.
  std::optional<assets::RecordedMesh> mesh(assets::Side) const;

 private:
  const Session& session_;
  bool capsules_ = false;
  PFN_xrLocateHandJointsEXT locate_ = nullptr;
  std::array<XrHandTrackerEXT, 2> trackers_{};
};

}  // namespace clothbench::xr
