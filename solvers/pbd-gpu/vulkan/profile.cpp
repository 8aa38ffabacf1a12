#include "vulkan/profile.hpp"

#include <set>
#include <spirv/unified1/spirv.hpp>

#include "clothbench/error.hpp"

namespace clothbench::vulkan {

const Profile& find_profile(const std::string& name) {
  static const Profile adreno = {"adreno-like", 32u << 10, 256, 64};
  if (name == adreno.name) return adreno;
  throw Error("device profile \"" + name + "\": expected " + adreno.name);
}

std::map<std::uint32_t, Access> accesses_of(SpirV code) {
  constexpr std::size_t kHeader = 5;
  std::map<std::uint32_t, std::uint32_t> binding, base;  // by variable; of a pointer into a variable
  std::set<std::uint32_t> read, written;                 // bindings
  const auto note = [&](std::set<std::uint32_t>& to, std::uint32_t pointer) {
    for (auto b = base.find(pointer); b != base.end(); b = base.find(pointer)) pointer = b->second;
    if (const auto b = binding.find(pointer); b != binding.end()) to.insert(b->second);
  };
  for (std::size_t k = kHeader; k < code.bytes / 4;) {
    const std::uint32_t* w = code.words + k;
    const std::uint32_t length = *w >> 16, op = *w & 0xffffu;
    if (length == 0 || k + length > code.bytes / 4) throw Error("SPIR-V: an instruction reaches past the end");
    const bool atomic = op >= spv::OpAtomicExchange && op <= spv::OpAtomicXor;
    if (op == spv::OpDecorate && w[2] == spv::DecorationBinding) binding[w[1]] = w[3];
    if (op == spv::OpAccessChain || op == spv::OpInBoundsAccessChain || op == spv::OpCopyObject) base[w[2]] = w[3];
    if (op == spv::OpLoad || op == spv::OpAtomicLoad || atomic) note(read, w[3]);
    if (op == spv::OpStore || op == spv::OpAtomicStore) note(written, w[1]);
    if (atomic) note(written, w[3]);
    k += length;
  }
  std::map<std::uint32_t, Access> found;
  for (const std::uint32_t b : read) found[b] = Access::Read;
  for (const std::uint32_t b : written) found[b] = read.contains(b) ? Access::ReadWrite : Access::Write;
  return found;
}

}  // namespace clothbench::vulkan
