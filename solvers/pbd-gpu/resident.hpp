#pragma once
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "clothbench/error.hpp"
#include "shaders.hpp"
#include "vulkan/program.hpp"

namespace clothbench::pbd_gpu {

/// Looks at who has come to a barrier of the whole dispatch, at loading and in a frame: some 10 ms and 1 s. A look
/// takes some 0.5 us on a GPU and 3 ns on a CPU.
struct Patience {
  std::uint32_t at_loading, in_a_frame;
};
inline Patience patience(const vulkan::Device& d) {
  return d.is_software() ? Patience{1u << 24, 1u << 30} : Patience{1u << 14, 1u << 21};
}

/// Does the device run all workgroups of this kernel at once (device_barrier.glsl)? Vulkan does not promise it, so they
/// are asked to meet, without work. `bindings(meeting, missed)` are the kernel's, `constants` have substeps 0. With
/// `must` an Error if not.
template <class Constants, class Bindings>
bool runs_at_once(const std::shared_ptr<vulkan::Device>& device, const Shader& shader,
                  std::vector<std::uint32_t> specialization, std::uint32_t threads, const Bindings& bindings,
                  vulkan::Groups groups, Constants constants, bool must) {
  constexpr double kPatience_s =
      60;  // a trial that takes longer has no device to itself, or none that is well: an error either way
  const vulkan::Buffer meeting(device, "meeting", 8, vulkan::Buffer::Place::Device);
  vulkan::Buffer zeros(device, "meeting (initial)", 8, vulkan::Buffer::Place::Host),
      missed(device, "missed", 4, vulkan::Buffer::Place::Host);
  std::memset(zeros.mapped(), 0, 8);
  std::memset(missed.mapped(), 0, 4);
  specialization.insert(specialization.begin(), threads);
  const vulkan::Kernel kernel(device, shader.name, shader.code, specialization, bindings(meeting, missed),
                              sizeof(Constants));
  vulkan::Program program(device);
  program.copy(0, zeros, meeting);
  constants.patience = patience(*device).at_loading;
  program.dispatch(0, kernel, groups, constants);
  program.record(false);
  program.run(kPatience_s);
  std::uint32_t failed = 0;
  std::memcpy(&failed, missed.mapped(), 4);
  if (failed != 0 && must)
    throw Error("solver xpbd: setting tuning.device_barrier=always: this device does not run " +
                std::to_string(groups.x * groups.y) + " workgroups of " + std::to_string(threads) + " at once");
  return failed == 0;
}

}  // namespace clothbench::pbd_gpu
