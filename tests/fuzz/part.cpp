// Runs as a sequence of CBOR items.
#include "fuzz.hpp"
#include "results/part_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace clothbench;
  const MemoryFile file(data, size);
  reads_or_refuses([&] { read_part(file.path()); });
  return 0;
}
