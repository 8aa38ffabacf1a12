#pragma once
#include <array>
#include <optional>

#include "assets/hand_recording.hpp"
#include "xr/session.hpp"

namespace clothbench::xr {

/// Hands tracked by the runtime (XR_EXT_hand_tracking), with its capsules if it provides them.
class Hands {
 public:
  explicit Hands(const Session&);
  ~Hands();
  Hands(const Hands&) = delete;
  Hands& operator=(const Hands&) = delete;

  /// The hand in the scene's space; empty unless every joint is known.
  std::optional<assets::RecordedHand> at(assets::Side, XrTime) const;
  bool has_capsules() const { return capsules_; }

 private:
  const Session& session_;
  bool capsules_ = false;
  PFN_xrLocateHandJointsEXT locate_ = nullptr;
  std::array<XrHandTrackerEXT, 2> trackers_{};
};

}  // namespace clothbench::xr
