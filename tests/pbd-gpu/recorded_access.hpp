#pragma once
#include <string>
#include <utility>
#include <vector>

#include "gpu_solver.hpp"

namespace clothbench::pbd_gpu {

/// What a kernel's SPIR-V does with each storage buffer, by binding: found in the code (loads, stores and atomics
/// through every pointer), not in what its qualifiers declare.
struct BufferUse {
  std::uint32_t binding = 0;
  bool read = false, written = false;
};
std::vector<BufferUse> uses_of(vulkan::SpirV code);
/// The kernel's binding of this number, which it has.
const vulkan::Binding& binding_of(const vulkan::Kernel&, std::uint32_t number);

/// One thing that happens on the queue's or the host's time line.
struct Event {
  enum class Kind { Access, Barrier } kind = Kind::Access;
  std::string name;
  // Access:
  VkPipelineStageFlags stage = 0;
  struct Touch {
    const vulkan::Buffer* buffer;
    bool read, written;
  };
  std::vector<Touch> touches;
  VkAccessFlags read_access = 0, write_access = 0;
  // Barrier:
  VkPipelineStageFlags before = 0, after = 0;
  VkAccessFlags made_available = 0, made_visible = 0;
  std::pair<const vulkan::Program*, std::size_t> source{nullptr,
                                                        0};  ///< which recorded barrier; null for implicit ones
};

/// Time line of the programs submitted one after another, each waited for; before the first and after the last the
/// host writes and reads the host buffers they use.
std::vector<Event> time_line(const std::vector<const vulkan::Program*>& submitted);

/// The first pair of accesses that no barrier orders, as text; empty if there is none. Barriers from `without` are
/// taken as absent.
std::string hazard(const std::vector<Event>& events,
                   std::pair<const vulkan::Program*, std::size_t> without = {nullptr, 0});

}  // namespace clothbench::pbd_gpu
