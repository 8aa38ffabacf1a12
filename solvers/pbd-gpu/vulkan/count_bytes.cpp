#include <spirv/unified1/spirv.hpp>

#include "vulkan/kernel.hpp"

namespace clothbench::vulkan {
namespace {

constexpr std::size_t kHeader = 5, kBound = 3;  // words of a module's header, and index of the word that bounds ids

using Id = std::uint32_t;
using Words = std::vector<std::uint32_t>;

void put(Words& to, spv::Op op, std::initializer_list<std::uint32_t> operands) {
  to.push_back(static_cast<std::uint32_t>(operands.size() + 1) << 16 | op);
  to.insert(to.end(), operands);
}

/// Reads a module once, in order: annotations, then types and variables, then functions.
class Counting {
 public:
  Counting(SpirV code, std::uint32_t counter, std::uint32_t first_word, const std::set<std::uint32_t>& uncounted)
      : code_(code), first_word_(first_word), uncounted_(uncounted), bound_(code.words[kBound]) {
    buffer_ = id();
    block_ = id();
    array_ = id();
    put(annotations_, spv::OpDecorate, {array_, spv::DecorationArrayStride, 4});
    put(annotations_, spv::OpMemberDecorate, {block_, 0, spv::DecorationOffset, 0});
    put(annotations_, spv::OpDecorate, {block_, spv::DecorationBlock});
    put(annotations_, spv::OpDecorate, {buffer_, spv::DecorationDescriptorSet, 0});
    put(annotations_, spv::OpDecorate, {buffer_, spv::DecorationBinding, counter});
  }

  Words all() {
    for (std::size_t k = kHeader, end = code_.bytes / 4; k < end; k += code_.words[k] >> 16) {
      const std::size_t length = code_.words[k] >> 16;
      if (length == 0 || k + length > end) throw Error("SPIR-V: an instruction reaches past the end");
      add(code_.words + k);
    }
    Words out(code_.words, code_.words + kHeader);
    out[kBound] = bound_;
    for (const Words* part : {&head_, &annotations_, &types_, &more_types_, &functions_})
      out.insert(out.end(), part->begin(), part->end());
    return out;
  }

  /// Call after all(), which reads the module.
  const std::map<std::uint32_t, Access>& accesses() const { return accesses_; }

 private:
  Id id() { return bound_++; }

  void add(const std::uint32_t* w) {
    const auto op = static_cast<spv::Op>(*w & 0xffffu);
    const bool in_functions = op == spv::OpFunction || !functions_.empty();
    if (op == spv::OpFunction && functions_.empty()) declare();
    if (op == spv::OpFunction) function_ = w[2];
    note(op, w);
    if (op == spv::OpReturn && function_ == entry_) flush();
    if (in_functions) count(op, w);
    const bool annotates =
        op == spv::OpDecorate || op == spv::OpMemberDecorate || (op < spv::OpTypeVoid && types_.empty());
    Words& to = in_functions ? functions_ : annotates ? head_ : types_;
    to.insert(to.end(), w, w + (*w >> 16));
  }

  /// Records sizes of types, pointers, and the buffers to which pointers lead.
  void note(spv::Op op, const std::uint32_t* w) {
    if (op == spv::OpEntryPoint) entry_ = w[2];
    if (op == spv::OpDecorate && w[2] == spv::DecorationBinding) binding_[w[1]] = w[3];
    if (op == spv::OpTypeBool) bool_ = w[1];
    if (op == spv::OpTypeInt && w[2] == 32 && w[3] == 0) uint_ = w[1];
    if (op == spv::OpTypeInt || op == spv::OpTypeFloat) size_[w[1]] = w[2] / 8;
    if (op == spv::OpTypeVector || op == spv::OpTypeMatrix) size_[w[1]] = size_[w[2]] * w[3];
    if (op == spv::OpTypeArray) size_[w[1]] = size_[w[2]] * constant_[w[3]];
    for (std::uint32_t m = 2; op == spv::OpTypeStruct && m < *w >> 16; ++m) size_[w[1]] += size_[w[m]];
    if (op == spv::OpConstant) constant_[w[2]] = w[3];
    if (op == spv::OpTypePointer && w[2] == spv::StorageClassStorageBuffer) pointee_[w[1]] = w[3];
    const bool derives = op == spv::OpAccessChain || op == spv::OpInBoundsAccessChain || op == spv::OpCopyObject;
    if (!(derives || op == spv::OpVariable) || !pointee_.contains(w[1])) return;
    pointer_[w[2]] = {pointee_[w[1]], derives ? pointer_[w[3]].binding : binding_[w[2]]};
  }

  /// Types, constants and variables that counting needs, after the module's own.
  void declare() {
    if (bool_ == 0) put(more_types_, spv::OpTypeBool, {bool_ = id()});
    if (uint_ == 0) put(more_types_, spv::OpTypeInt, {uint_ = id(), 32, 0});
    put(more_types_, spv::OpTypeRuntimeArray, {array_, uint_});
    put(more_types_, spv::OpTypeStruct, {block_, array_});
    const Id to_block = id(), to_sum = id();
    to_word_ = id();
    put(more_types_, spv::OpTypePointer, {to_block, spv::StorageClassStorageBuffer, block_});
    put(more_types_, spv::OpTypePointer, {to_word_, spv::StorageClassStorageBuffer, uint_});
    put(more_types_, spv::OpTypePointer, {to_sum, spv::StorageClassPrivate, uint_});
    put(more_types_, spv::OpVariable, {to_block, buffer_, spv::StorageClassStorageBuffer});
    for (Id& sum : sums_) put(more_types_, spv::OpVariable, {to_sum, sum = id(), spv::StorageClassPrivate, value(0)});
  }

  /// Id of an unsigned constant, which is declared on first use.
  Id value(std::uint32_t number) {
    const auto [at, fresh] = value_.try_emplace(number, 0);
    if (fresh) put(more_types_, spv::OpConstant, {uint_, at->second = id(), number});
    return at->second;
  }

  Id result(spv::Op op, Id type, std::initializer_list<std::uint32_t> operands) {
    const Id made = id();
    functions_.push_back(static_cast<std::uint32_t>(operands.size() + 3) << 16 | op);
    functions_.insert(functions_.end(), {type, made});
    functions_.insert(functions_.end(), operands);
    return made;
  }

  void count(spv::Op op, const std::uint32_t* w) {
    const bool atomic = op >= spv::OpAtomicExchange && op <= spv::OpAtomicXor;
    if (op == spv::OpLoad || op == spv::OpAtomicLoad || atomic) access(0, w[3]);
    if (op == spv::OpStore || op == spv::OpAtomicStore) access(1, w[1]);
    if (atomic) access(1, w[3]);
  }

  void access(std::size_t written, Id pointer) {
    const auto at = pointer_.find(pointer);
    if (at == pointer_.end()) return;
    const Access now = written != 0 ? Access::Write : Access::Read;
    const auto [access, fresh] = accesses_.try_emplace(at->second.binding, now);
    if (!fresh && access->second != now) access->second = Access::ReadWrite;
    if (uncounted_.contains(at->second.binding)) return;
    const Id size = value(size_.at(at->second.type)), sum = sums_[written];
    const Id more = result(spv::OpIAdd, uint_, {result(spv::OpLoad, uint_, {sum}), size});
    put(functions_, spv::OpStore, {sum, more});
  }

  /// Adds both sums to the buffer, with the carry into the high word.
  void flush() {
    for (std::uint32_t k = 0; k < 2; ++k) {
      const auto word = [&](std::uint32_t n) {
        return result(spv::OpAccessChain, to_word_, {buffer_, value(0), value(first_word_ + 2 * k + n)});
      };
      const auto add_to = [&](Id to, Id what) {
        return result(spv::OpAtomicIAdd, uint_, {to, value(spv::ScopeDevice), value(0), what});
      };
      const Id sum = result(spv::OpLoad, uint_, {sums_[k]}), before = add_to(word(0), sum);
      const Id wraps = result(spv::OpULessThan, bool_, {result(spv::OpIAdd, uint_, {before, sum}), sum});
      add_to(word(1), result(spv::OpSelect, uint_, {wraps, value(1), value(0)}));
    }
  }

  struct Pointer {
    Id type;
    std::uint32_t binding;
  };
  const SpirV code_;
  const std::uint32_t first_word_;
  const std::set<std::uint32_t> uncounted_;
  Id bound_, buffer_ = 0, block_ = 0, array_ = 0, to_word_ = 0, uint_ = 0, bool_ = 0, entry_ = 0, function_ = 0;
  Id sums_[2] = {};  ///< bytes read, bytes written
  std::map<Id, std::uint32_t> binding_, size_, constant_, value_;
  std::map<Id, Id> pointee_;
  std::map<Id, Pointer> pointer_;
  std::map<std::uint32_t, Access> accesses_;
  Words head_, annotations_, types_, more_types_, functions_;
};

}  // namespace

std::map<std::uint32_t, Access> accesses_of(SpirV code) {
  Counting module(code, 0, 0, {});
  module.all();
  return module.accesses();
}

std::vector<std::uint32_t> with_byte_counters(SpirV code, std::uint32_t counter, std::uint32_t first_word,
                                              const std::set<std::uint32_t>& uncounted) {
  return Counting(code, counter, first_word, uncounted).all();
}

}  // namespace clothbench::vulkan
