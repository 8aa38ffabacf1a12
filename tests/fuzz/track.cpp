// Hand tracks: text to keys, and those at another speed.
#include "assets/hand_track.hpp"
#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace clothbench;
  reads_or_refuses([&] {
    const assets::HandTrack track = assets::parse_hand_track(std::string(reinterpret_cast<const char*>(data), size), "track.json");
    assets::retimed(track, 2);
  });
  return 0;
}
