// Cloth meshes: the bytes of a glTF file, binary or text, to a checked mesh.
#include "assets/mesh_file.hpp"
#include "fuzz.hpp"
#include "scenario/cloth_mesh.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace clothbench;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  reads_or_refuses([&] { cloth_mesh(assets::parse_gltf(bytes, "mesh.gltf"), "mesh.gltf"); });
  return 0;
}
