#include "vulkan/profile.hpp"

#include <fmt/format.h>

#include <map>
#include <set>
#include <spirv/unified1/spirv.hpp>

#include "base/words.hpp"
#include "clothbench/error.hpp"

namespace clothbench::vulkan {
namespace {

const std::set<std::uint32_t> kAtomicFloat = {
    spv::CapabilityAtomicFloat16AddEXT,    spv::CapabilityAtomicFloat32AddEXT,
    spv::CapabilityAtomicFloat64AddEXT,    spv::CapabilityAtomicFloat16MinMaxEXT,
    spv::CapabilityAtomicFloat32MinMaxEXT, spv::CapabilityAtomicFloat64MinMaxEXT};

/// Reads a module's types and constants by id. One pass in order is enough, because ids are defined before their uses.
class Reader {
 public:
  explicit Reader(const std::vector<std::uint32_t>& specialization) : specialization_(specialization) {}

  void take(std::uint32_t op, std::uint32_t length, const std::uint32_t* w) {
    switch (op) {
      case spv::OpCapability:
        needs_.float_atomics |= kAtomicFloat.count(w[1]) != 0;
        break;
      case spv::OpExecutionMode:
        if (w[2] == spv::ExecutionModeLocalSize)
          for (int k = 0; k < 3; ++k) needs_.group[k] = w[3 + k];
        break;
      case spv::OpDecorate:
        if (w[2] == spv::DecorationSpecId) spec_id_[w[1]] = w[3];
        if (w[2] == spv::DecorationBinding) binding_[w[1]] = w[3];
        restrict(w[1], w[2]);
        if (w[2] == spv::DecorationBuiltIn && w[3] == spv::BuiltInWorkgroupSize) group_id_ = w[1];
        break;
      case spv::OpMemberDecorate:
        restrict(w[1], w[3]);
        break;
      case spv::OpTypeInt:
      case spv::OpTypeFloat:
        size_[w[1]] = w[2] / 8;
        break;
      case spv::OpTypeVector:
      case spv::OpTypeMatrix:
        size_[w[1]] = size_[w[2]] * w[3];
        break;
      case spv::OpTypeArray:
        size_[w[1]] = size_[w[2]] * value_[w[3]];
        break;
      case spv::OpTypeStruct:
        for (std::uint32_t k = 2; k < length; ++k) size_[w[1]] += size_[w[k]];
        break;
      case spv::OpTypePointer:
        size_[w[1]] = size_[w[3]];
        pointee_[w[1]] = w[3];
        break;
      case spv::OpConstant:
        value_[w[2]] = w[3];
        break;
      case spv::OpSpecConstant:
        value_[w[2]] = specialized(w[2], w[3]);
        break;
      case spv::OpSpecConstantOp:
        if (w[3] == spv::OpIMul) value_[w[2]] = value_[w[4]] * value_[w[5]];
        break;
      case spv::OpConstantComposite:
      case spv::OpSpecConstantComposite:
        // The built-in overrides the execution mode (section 3.21, WorkgroupSize).
        if (w[2] == group_id_)
          for (int k = 0; k < 3; ++k) needs_.group[k] = static_cast<std::uint32_t>(value_[w[3 + k]]);
        break;
      case spv::OpVariable:
        if (w[3] == spv::StorageClassWorkgroup) needs_.shared_memory_B += size_[w[1]];
        if (const auto b = binding_.find(w[2]); b != binding_.end()) {
          const auto is = [&](const std::set<std::uint32_t>& ids) {
            return ids.count(w[2]) + ids.count(pointee_[w[1]]) > 0;
          };
          needs_.bindings[b->second] = is(readonly_)    ? Access::Read
                                       : is(writeonly_) ? Access::Write
                                                        : Access::ReadWrite;
        }
        break;
      default:
        break;
    }
  }
  const ShaderNeeds& needs() const { return needs_; }

 private:
  std::uint32_t specialized(std::uint32_t id, std::uint32_t standard) const {
    const auto spec = spec_id_.find(id);
    return spec != spec_id_.end() && spec->second < specialization_.size() ? specialization_[spec->second] : standard;
  }

  /// Marks a block or a variable as readonly or writeonly.
  void restrict(std::uint32_t id, std::uint32_t decoration) {
    if (decoration == spv::DecorationNonWritable) readonly_.insert(id);
    if (decoration == spv::DecorationNonReadable) writeonly_.insert(id);
  }

  const std::vector<std::uint32_t>& specialization_;
  std::set<std::uint32_t> readonly_, writeonly_;
  std::map<std::uint32_t, std::uint32_t> binding_, pointee_;
  std::map<std::uint32_t, std::uint64_t> size_, value_;
  std::map<std::uint32_t, std::uint32_t> spec_id_;
  std::uint32_t group_id_ = 0;
  ShaderNeeds needs_;
};

const std::vector<Profile>& profiles() {
  static const std::vector<Profile> all = {{"adreno-like", 32u << 10, 256, 64, 64, 128, false}};
  return all;
}

}  // namespace

const Profile& find_profile(const std::string& name) {
  for (const Profile& p : profiles())
    if (p.name == name) return p;
  throw Error("device profile \"" + name + "\": expected one of " + joined(profile_names()));
}

std::vector<std::string> profile_names() {
  std::vector<std::string> names;
  for (const Profile& p : profiles()) names.push_back(p.name);
  return names;
}

ShaderNeeds needs_of(SpirV code, const std::vector<std::uint32_t>& specialization) {
  constexpr std::size_t kHeader = 5;
  Reader reader(specialization);
  for (std::size_t k = kHeader; k < code.bytes / 4;) {
    const std::uint32_t length = code.words[k] >> 16;
    if (length == 0 || k + length > code.bytes / 4) throw Error("SPIR-V: an instruction reaches past the end");
    reader.take(code.words[k] & 0xffffu, length, code.words + k);
    k += length;
  }
  return reader.needs();
}

std::string breach(const Profile& p, const ShaderNeeds& n) {
  if (n.group[1] != 1 || n.group[2] != 1)
    return fmt::format("its workgroups of {} x {} x {} are not one-dimensional", n.group[0], n.group[1], n.group[2]);
  if (n.group[0] > p.group_invocations)
    return fmt::format("its workgroups of {} are larger than {}", n.group[0], p.group_invocations);
  if (n.shared_memory_B > p.shared_memory_B)
    return fmt::format("its {} B of shared memory are more than {} B", n.shared_memory_B, p.shared_memory_B);
  if (n.float_atomics && !p.float_atomics) return "it uses float atomics";
  return "";
}

}  // namespace clothbench::vulkan
