// One libFuzzer program for all readers; $READER selects one.
#include <cstdio>
#include <map>

#include "fuzz.hpp"

namespace {

const std::map<std::string, void (*)(const std::uint8_t*, std::size_t)> kReaders = {
    {"scene", clothbench::fuzz_scene}, {"obj", clothbench::fuzz_obj},   {"gltf", clothbench::fuzz_gltf},
    {"room", clothbench::fuzz_room},   {"hand", clothbench::fuzz_hand}, {"track", clothbench::fuzz_track},
    {"part", clothbench::fuzz_part},   {"hdf5", clothbench::fuzz_hdf5}};
void (*reader)(const std::uint8_t*, std::size_t) = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* name = std::getenv("READER");
  if (name == nullptr || !kReaders.contains(name)) {
    std::fputs("READER: expected scene, obj, gltf, room, hand, track, part or hdf5\n", stderr);
    std::exit(2);
  }
  reader = kReaders.at(name);
  return setenv("CLOTHBENCH_ASSETS", "procedural", 1);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  reader(data, size);
  return 0;
}
