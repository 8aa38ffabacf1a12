// Cloth meshes: the bytes of a glTF file, binary or text, to a checked mesh, with its vertices or its texture
// coordinates as the shape at rest.
#include "assets/mesh_file.hpp"
#include "fuzz.hpp"
#include "scenario/cloth_mesh.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace clothbench;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  for (const double unit_m : {0.0, 0.5})
    reads_or_refuses([&] { cloth_mesh(assets::parse_gltf(bytes, "mesh.gltf"), {unit_m, 0.001}, "mesh.gltf"); });
  return 0;
}
