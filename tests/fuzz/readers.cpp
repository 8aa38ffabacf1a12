// One libFuzzer program for all readers; $READER selects one.
#include <cstdio>
#include <map>

#include "assets/mesh_file.hpp"
#include "assets/room.hpp"
#include "fuzz.hpp"
#include "results/part_file.hpp"
#include "scenario/cloth_mesh.hpp"

namespace {

using namespace clothbench;

template <class Read>
void read_text_of(const std::uint8_t* data, std::size_t size, Read read) {
  reads_or_refuses([&] { read(std::string(reinterpret_cast<const char*>(data), size)); });
}

void fuzz_obj(const std::uint8_t* data, std::size_t size) {
  read_text_of(data, size, [](const std::string& t) { cloth_mesh(read_obj(t, "mesh.obj"), "mesh.obj"); });
}
void fuzz_gltf(const std::uint8_t* data, std::size_t size) {
  read_text_of(data, size, [](const std::string& t) { cloth_mesh(assets::parse_gltf(t, "mesh.gltf"), "mesh.gltf"); });
}
void fuzz_room(const std::uint8_t* data, std::size_t size) {
  read_text_of(data, size, [](const std::string& t) { assets::parse_room(t, "room.json", "room"); });
}
void fuzz_part(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size);
  reads_or_refuses([&] { read_part(file.path()); });
}

const std::map<std::string, void (*)(const std::uint8_t*, std::size_t)> kReaders = {
    {"scene", fuzz_scene}, {"obj", fuzz_obj},     {"gltf", fuzz_gltf}, {"room", fuzz_room},
    {"hand", fuzz_hand},   {"track", fuzz_track}, {"part", fuzz_part}, {"hdf5", fuzz_hdf5}};
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
