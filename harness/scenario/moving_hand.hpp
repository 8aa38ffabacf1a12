#pragma once
#include <optional>

#include "assets/hand_track.hpp"
#include "scenario/collider_reader.hpp"
#include "scenario/recorded_hand.hpp"

namespace clothbench {

/// A hand on its way; keeps what is needed to sample it.
struct MovingHand {
  std::optional<assets::Hand> hand;  ///< none where a recording needs none
  assets::HandTrack track;
  std::optional<assets::HandRecording> recording;    ///< instead of the track
  assets::Vector offset_m = assets::Vector::Zero();  ///< of the whole track
};

/// By the keys `track` and `speed_m_per_s` of a collider or a grip.
MovingHand moving_hand(const nlohmann::json&, ColliderReader&, bool as_mesh);

/// A hand's mesh, or its capsules.
void read_hand(const nlohmann::json&, ColliderReader&, Collider&, bool as_mesh);

}  // namespace clothbench
