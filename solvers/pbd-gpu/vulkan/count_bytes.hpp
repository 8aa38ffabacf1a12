#pragma once
#include <set>
#include <vector>

#include "vulkan/kernel.hpp"

namespace clothbench::vulkan {

/// Code that does what `code` does, and counts the bytes of storage buffers that it loads and stores, on whatever path
/// it takes. An invocation keeps its two sums to itself and adds them at its end to four words of buffer `counter`,
/// from `first_word` on: bytes read (low and high word), bytes written. An atomic operation reads and writes its word.
/// Accesses to the bindings `uncounted` are left out: how often a barrier is polled depends on timing.
std::vector<std::uint32_t> with_byte_counters(SpirV code, std::uint32_t counter, std::uint32_t first_word,
                                              const std::set<std::uint32_t>& uncounted);

}  // namespace clothbench::vulkan
