#pragma once
#include <cstdint>
#include <map>
#include <string>

namespace clothbench::vulkan {

struct SpirV {
  const std::uint32_t* words;
  std::size_t bytes;
};

/// A class of devices that any device can emulate: its limits are reduced to these, larger workgroups are rejected, and
/// a frame is split into submissions as short as on such a device.
struct Profile {
  std::string name;
  std::uint32_t shared_memory_B = 0;    ///< of a workgroup
  std::uint32_t group_invocations = 0;  ///< workgroups are one-dimensional and at most this wide
  std::uint32_t dispatches_per_submit = 0;
};

/// "adreno-like": what is known of the Adreno 740 of a Quest 3, 32 KiB of shared memory (Mesa, freedreno_devices.py,
/// cs_shared_mem_size). The limits of 256 threads a group and 64 dispatches a submission are our precaution. Throws
/// Error naming it for any other name.
const Profile& find_profile(const std::string& name);

enum class Access { Read, Write, ReadWrite };

/// What a kernel's code does with storage buffers, by binding: its loads, stores and atomics through every pointer.
std::map<std::uint32_t, Access> accesses_of(SpirV code);

}  // namespace clothbench::vulkan
