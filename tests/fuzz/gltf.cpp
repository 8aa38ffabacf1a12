// Cloth meshes: the bytes of a glTF file, binary or text, to a checked mesh.
#include "assets/mesh_file.hpp"
#include "fuzz.hpp"
#include "scenario/cloth_mesh.hpp"

void clothbench::fuzz_gltf(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  reads_or_refuses([&] { cloth_mesh(assets::parse_gltf(bytes, "mesh.gltf"), "mesh.gltf"); });
}
