// Hand tracks: text to keys, and the keys at another speed. Hand recordings: text to the capsules of the first frame.
#include "assets/hand_track.hpp"
#include "fuzz.hpp"

void clothbench::fuzz_track(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  reads_or_refuses([&] {
    const assets::HandRecording recording = assets::parse_hand_recording(text, "track.json");
    assets::capsules(recording, recording.at(0));
  });
  reads_or_refuses([&] {
    const assets::HandTrack track = assets::parse_hand_track(text, "track.json");
    assets::retimed(track, 2);
  });
}
