// Runs as a sequence of CBOR items.
#include "fuzz.hpp"
#include "results/part_file.hpp"

void clothbench::fuzz_part(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size);
  reads_or_refuses([&] { read_part(file.path()); });
}
