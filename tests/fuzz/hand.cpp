// Hands: binary glTF to a skinned mesh. An input that begins with { has the JSON of a file, a zero byte and the binary
// part; this program adds the container.
#include "assets/hand.hpp"

#include <algorithm>
#include <string>

#include "fuzz.hpp"
#include "scenario/collider_reader.hpp"

namespace {

void put(std::string& to, std::uint32_t v) {
  for (int k = 0; k < 4; ++k) to.push_back(static_cast<char>(v >> 8 * k));
}

void put_chunk(std::string& to, std::uint32_t kind, const std::uint8_t* data, std::size_t size, char filler) {
  const std::size_t padded = (size + 3) / 4 * 4;
  put(to, static_cast<std::uint32_t>(padded));
  put(to, kind);
  to.append(data, data + size).append(padded - size, filler);
}

std::string container(const std::uint8_t* data, std::size_t size) {
  const std::uint8_t* end = std::find(data, data + size, std::uint8_t{0});
  std::string chunks, out = "glTF";
  put_chunk(chunks, 0x4e4f534a, data, static_cast<std::size_t>(end - data), ' ');
  if (end != data + size) put_chunk(chunks, 0x004e4942, end + 1, static_cast<std::size_t>(data + size - end - 1), 0);
  put(out, 2);
  put(out, static_cast<std::uint32_t>(12 + chunks.size()));
  return out + chunks;
}

}  // namespace

void clothbench::fuzz_hand(const std::uint8_t* data, std::size_t size) {
  reads_or_refuses([&] {
    const assets::SkinnedMesh hand = assets::parse_hand_glb(
        size > 0 && data[0] == '{' ? container(data, size) : std::string(data, data + size), "hand.glb");
    collider_mesh(hand);
  });
}
