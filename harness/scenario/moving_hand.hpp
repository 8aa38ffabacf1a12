#pragma once
#include <optional>

#include "assets/hand_track.hpp"
#include "scenario/collider_reader.hpp"
#include "scenario/recorded_hand.hpp"

namespace clothbench {

/// A moving hand, with the data to sample its motion.
struct MovingHand {
  std::optional<assets::Hand> hand;  ///< empty if a recording needs no hand model
  assets::HandTrack track;
  std::optional<assets::HandRecording> recording;    ///< instead of the track
  assets::Vector offset_m = assets::Vector::Zero();  ///< of the whole track
};

/// Reads the keys `track` and `speed_m_per_s` of a collider or a grip.
MovingHand moving_hand(const nlohmann::json&, ColliderReader&, bool as_mesh);

/// Reads a hand as a collider: its mesh, or its capsules.
void read_hand(const nlohmann::json&, ColliderReader&, Collider&, bool as_mesh);

}  // namespace clothbench
