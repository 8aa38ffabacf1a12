// Cloth meshes: the text of an OBJ file to a checked mesh.
#include "fuzz.hpp"
#include "scenario/cloth_mesh.hpp"

void clothbench::fuzz_obj(const std::uint8_t* data, std::size_t size) {
  reads_or_refuses(
      [&] { cloth_mesh(read_obj(std::string(reinterpret_cast<const char*>(data), size), "mesh.obj"), "mesh.obj"); });
}
