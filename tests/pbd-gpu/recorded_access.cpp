#include "recorded_access.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <spirv/unified1/spirv.hpp>

namespace clothbench::pbd_gpu {
namespace {

constexpr VkAccessFlags kAnyAccess = ~VkAccessFlags{0};

struct Module {
  std::map<std::uint32_t, std::uint32_t> binding_of, base;
  std::set<std::uint32_t> read, written;

  std::uint32_t variable(std::uint32_t pointer) const {
    for (auto b = base.find(pointer); b != base.end(); b = base.find(pointer)) pointer = b->second;
    return pointer;
  }

  void take(std::uint32_t op, const std::uint32_t* w) {
    if (op == spv::OpDecorate && w[2] == spv::DecorationBinding) binding_of[w[1]] = w[3];
    if (op == spv::OpAccessChain || op == spv::OpInBoundsAccessChain || op == spv::OpCopyObject) base[w[2]] = w[3];
    if (op == spv::OpLoad || op == spv::OpAtomicLoad) read.insert(variable(w[3]));
    if (op == spv::OpStore || op == spv::OpAtomicStore) written.insert(variable(w[1]));
    if ((op >= spv::OpAtomicExchange && op <= spv::OpAtomicXor) || op == spv::OpAtomicFAddEXT) {
      read.insert(variable(w[3]));
      written.insert(variable(w[3]));
    }
  }
};

Event implicit_barrier(const char* name, VkPipelineStageFlags before, VkPipelineStageFlags after,
                       VkAccessFlags available, VkAccessFlags visible) {
  Event e;
  e.kind = Event::Kind::Barrier;
  e.name = name;
  e.before = before;
  e.after = after;
  e.made_available = available;
  e.made_visible = visible;
  return e;
}

Event work(const vulkan::Program::Recorded& r) {
  Event e;
  if (r.kernel == nullptr) {
    e.name = "copy " + r.from->name() + " -> " + r.to->name();
    e.stage = VK_PIPELINE_STAGE_TRANSFER_BIT;
    e.read_access = VK_ACCESS_TRANSFER_READ_BIT;
    e.write_access = VK_ACCESS_TRANSFER_WRITE_BIT;
    e.touches = {{r.from, true, false}, {r.to, false, true}};
    return e;
  }
  e.name = r.kernel->name();
  e.stage = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT;
  e.read_access = VK_ACCESS_SHADER_READ_BIT;
  e.write_access = VK_ACCESS_SHADER_WRITE_BIT;
  for (const BufferUse& u : uses_of(r.kernel->code()))
    e.touches.push_back({binding_of(*r.kernel, u.binding).buffer, u.read, u.written});
  return e;
}

/// The host fills what is copied from and reads what is copied to.
Event host(const std::set<const vulkan::Buffer*>& filled, const std::set<const vulkan::Buffer*>& fetched) {
  Event e;
  e.name = "host";
  e.stage = VK_PIPELINE_STAGE_HOST_BIT;
  e.read_access = VK_ACCESS_HOST_READ_BIT;
  e.write_access = VK_ACCESS_HOST_WRITE_BIT;
  for (const vulkan::Buffer* b : filled) e.touches.push_back({b, false, true});
  for (const vulkan::Buffer* b : fetched) e.touches.push_back({b, true, false});
  return e;
}

/// Does barrier b order `first` before `second`, and show what `first` wrote?
bool orders(const Event& b, const Event& first, const Event& second, const Event::Touch& f, const Event::Touch& s) {
  if ((b.before & first.stage) == 0 || (b.after & second.stage) == 0) return false;
  if (!f.written) return true;  // write after read: execution order is enough
  const VkAccessFlags next = (s.read ? second.read_access : 0) | (s.written ? second.write_access : 0);
  return (b.made_available & first.write_access) != 0 && (b.made_visible & next) == next;
}

}  // namespace

const vulkan::Binding& binding_of(const vulkan::Kernel& kernel, std::uint32_t number) {
  const auto& all = kernel.bindings();
  return *std::find_if(all.begin(), all.end(), [&](const vulkan::Binding& b) { return b.number == number; });
}

std::vector<BufferUse> uses_of(vulkan::SpirV code) {
  Module m;
  constexpr std::size_t kHeader = 5;
  for (std::size_t k = kHeader; k < code.bytes / 4; k += code.words[k] >> 16)
    m.take(code.words[k] & 0xffff, code.words + k);
  std::vector<BufferUse> uses;
  for (const auto& [variable, binding] : m.binding_of)
    uses.push_back({binding, m.read.count(variable) != 0, m.written.count(variable) != 0});
  return uses;
}

std::vector<Event> time_line(const std::vector<const vulkan::Program*>& submitted) {
  std::set<const vulkan::Buffer*> filled, fetched;
  for (const vulkan::Program* p : submitted)
    for (const auto& r : p->recorded()) {
      if (r.from != nullptr && r.from->place() == vulkan::Buffer::Place::Host) filled.insert(r.from);
      if (r.to != nullptr && r.to->place() == vulkan::Buffer::Place::Host) fetched.insert(r.to);
      if (r.kernel == nullptr) continue;
      for (const vulkan::Binding& b : r.kernel->bindings())  // a kernel's own counts in host memory
        if (b.access != vulkan::Access::Read && b.buffer->place() == vulkan::Buffer::Place::Host)
          fetched.insert(b.buffer);
    }
  constexpr VkPipelineStageFlags kEverything = ~VkPipelineStageFlags{0};
  std::vector<Event> events = {host(filled, fetched)};
  for (const vulkan::Program* p : submitted) {
    // vkQueueSubmit shows the device what the host wrote; it says nothing of earlier submissions.
    events.push_back(
        implicit_barrier("submit", VK_PIPELINE_STAGE_HOST_BIT, kEverything, VK_ACCESS_HOST_WRITE_BIT, kAnyAccess));
    std::size_t barriers = 0;
    for (const auto& r : p->recorded()) {
      if (!r.is_barrier) {
        events.push_back(work(r));
        continue;
      }
      events.push_back(implicit_barrier("recorded", r.stages_before, r.stages_after, r.written, r.next));
      events.back().source = {p, barriers++};
    }
    // Waiting for the fence orders, but shows the host nothing.
    events.push_back(implicit_barrier("fence", kEverything, VK_PIPELINE_STAGE_HOST_BIT, 0, 0));
    events.push_back(host(filled, fetched));
  }
  return events;
}

std::string hazard(const std::vector<Event>& events, std::pair<const vulkan::Program*, std::size_t> without) {
  for (std::size_t j = 0; j < events.size(); ++j) {
    std::vector<const Event*> between;
    for (std::size_t i = j; events[j].kind == Event::Kind::Access && i-- > 0;) {
      const Event& first = events[i];
      if (first.kind == Event::Kind::Barrier) {
        if (first.source.first == nullptr || first.source != without) between.push_back(&first);
        continue;
      }
      // The host is in order with itself.
      if (first.stage == VK_PIPELINE_STAGE_HOST_BIT && events[j].stage == VK_PIPELINE_STAGE_HOST_BIT) continue;
      for (const auto& f : first.touches)
        for (const auto& s : events[j].touches) {
          if (f.buffer != s.buffer || !((f.written && (s.read || s.written)) || (f.read && s.written))) continue;
          const bool ordered = std::any_of(between.begin(), between.end(),
                                           [&](const Event* b) { return orders(*b, first, events[j], f, s); });
          if (!ordered)
            return fmt::format("{} then {} on \"{}\" (events {} and {})", first.name, events[j].name, f.buffer->name(),
                               i, j);
        }
    }
  }
  return "";
}

}  // namespace clothbench::pbd_gpu
