#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace clothbench::vulkan {

struct SpirV {
  const std::uint32_t* words;
  std::size_t bytes;
};

/// A class of devices that any device can emulate: its limits are reduced to these, kernels that exceed them are
/// rejected, and a frame is split into submissions as short as on such a device.
struct Profile {
  std::string name;
  std::uint32_t shared_memory_B = 0;    ///< of a workgroup
  std::uint32_t group_invocations = 0;  ///< workgroups are one-dimensional and at most this wide
  std::uint32_t dispatches_per_submit = 0;
  std::uint32_t subgroup_min = 0, subgroup_max = 0;  ///< assumed; no kernel may rely on one size
  bool float_atomics = false;
};

/// "adreno-like": what is known of the Adreno 740 of a Quest 3. 32 KiB of shared memory (Mesa, freedreno_devices.py,
/// cs_shared_mem_size), subgroups of 64 to 128 (gfx-rs/wgpu issue 8801), VK_EXT_shader_atomic_float not confirmed. The
/// limits of 256 threads a group and 64 dispatches a submission are our precaution. Throws Error naming known profiles.
const Profile& find_profile(const std::string& name);

/// Names `find_profile` knows.
std::vector<std::string> profile_names();

enum class Access { Read, Write, ReadWrite };

/// What a compute shader needs of a device and its caller, read from its code. `specialization[k]` is the value of
/// constant id k.
struct ShaderNeeds {
  std::uint32_t group[3] = {1, 1, 1};
  std::uint64_t shared_memory_B = 0;              ///< of its Workgroup variables, without padding
  bool float_atomics = false;                     ///< declares any AtomicFloat… capability
  std::map<std::uint32_t, Access> bindings = {};  ///< storage buffers, by number
};
ShaderNeeds needs_of(SpirV code, const std::vector<std::uint32_t>& specialization);

/// Reason why a shader would not run under the profile; empty if it would.
std::string breach(const Profile&, const ShaderNeeds&);

}  // namespace clothbench::vulkan
