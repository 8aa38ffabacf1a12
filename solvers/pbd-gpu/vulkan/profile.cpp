#include "vulkan/profile.hpp"

#include <fmt/format.h>

#include <map>
#include <set>

#include "clothbench/error.hpp"

namespace clothbench::vulkan {
namespace {

// Numbers of the SPIR-V specification, sections 3.6, 3.20, 3.21, 3.31 and 3.52.
constexpr std::uint32_t kOpExecutionMode = 16, kOpCapability = 17, kOpTypeInt = 21, kOpTypeFloat = 22,
                        kOpTypeVector = 23, kOpTypeMatrix = 24, kOpTypeArray = 28, kOpTypeStruct = 30,
                        kOpTypePointer = 32, kOpConstant = 43, kOpConstantComposite = 44, kOpSpecConstant = 50,
                        kOpSpecConstantComposite = 51, kOpSpecConstantOp = 52, kOpVariable = 59, kOpDecorate = 71,
                        kOpMemberDecorate = 72, kIMul = 132;
constexpr std::uint32_t kModeLocalSize = 17, kDecorationSpecId = 1, kDecorationBuiltIn = 11,
                        kDecorationNonWritable = 24, kDecorationNonReadable = 25, kDecorationBinding = 33,
                        kBuiltInWorkgroupSize = 25, kClassWorkgroup = 4;
const std::set<std::uint32_t> kAtomicFloat = {5612, 5613, 5616, 6033, 6034, 6095};

/// Reads a module's types and constants by id. One pass in order is enough, because ids are defined before their uses.
class Reader {
 public:
  explicit Reader(const std::vector<std::uint32_t>& specialization) : specialization_(specialization) {}

  void take(std::uint32_t op, std::uint32_t length, const std::uint32_t* w) {
    switch (op) {
      case kOpCapability:
        needs_.float_atomics |= kAtomicFloat.count(w[1]) != 0;
        break;
      case kOpExecutionMode:
        if (w[2] == kModeLocalSize)
          for (int k = 0; k < 3; ++k) needs_.group[k] = w[3 + k];
        break;
      case kOpDecorate:
        if (w[2] == kDecorationSpecId) spec_id_[w[1]] = w[3];
        if (w[2] == kDecorationBinding) binding_[w[1]] = w[3];
        restrict(w[1], w[2]);
        if (w[2] == kDecorationBuiltIn && w[3] == kBuiltInWorkgroupSize) group_id_ = w[1];
        break;
      case kOpMemberDecorate:
        restrict(w[1], w[3]);
        break;
      case kOpTypeInt:
      case kOpTypeFloat:
        size_[w[1]] = w[2] / 8;
        break;
      case kOpTypeVector:
      case kOpTypeMatrix:
        size_[w[1]] = size_[w[2]] * w[3];
        break;
      case kOpTypeArray:
        size_[w[1]] = size_[w[2]] * value_[w[3]];
        break;
      case kOpTypeStruct:
        for (std::uint32_t k = 2; k < length; ++k) size_[w[1]] += size_[w[k]];
        break;
      case kOpTypePointer:
        size_[w[1]] = size_[w[3]];
        pointee_[w[1]] = w[3];
        break;
      case kOpConstant:
        value_[w[2]] = w[3];
        break;
      case kOpSpecConstant:
        value_[w[2]] = specialized(w[2], w[3]);
        break;
      case kOpSpecConstantOp:
        if (w[3] == kIMul) value_[w[2]] = value_[w[4]] * value_[w[5]];
        break;
      case kOpConstantComposite:
      case kOpSpecConstantComposite:
        // The built-in overrides the execution mode (section 3.21, WorkgroupSize).
        if (w[2] == group_id_)
          for (int k = 0; k < 3; ++k) needs_.group[k] = static_cast<std::uint32_t>(value_[w[3 + k]]);
        break;
      case kOpVariable:
        if (w[3] == kClassWorkgroup) needs_.shared_memory_B += size_[w[1]];
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
    if (decoration == kDecorationNonWritable) readonly_.insert(id);
    if (decoration == kDecorationNonReadable) writeonly_.insert(id);
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
  std::string known;
  for (const Profile& p : profiles()) {
    if (p.name == name) return p;
    known += (known.empty() ? "" : ", ") + p.name;
  }
  throw Error("device profile \"" + name + "\": expected one of " + known);
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
