// Room captures: text to mesh and tables.
#include "assets/room.hpp"

#include "fuzz.hpp"

void clothbench::fuzz_room(const std::uint8_t* data, std::size_t size) {
  reads_or_refuses(
      [&] { assets::parse_room(std::string(reinterpret_cast<const char*>(data), size), "room.json", "room"); });
}
