// Cloth meshes: the text of an OBJ file to a checked mesh.
#include "fuzz.hpp"
#include "scenario/cloth_mesh.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace clothbench;
  reads_or_refuses([&] { parse_obj(std::string(reinterpret_cast<const char*>(data), size), "mesh.obj"); });
  return 0;
}
