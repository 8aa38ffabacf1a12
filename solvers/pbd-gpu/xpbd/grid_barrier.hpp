#pragma once
#include <cstring>
#include <string>

#include "clothbench/error.hpp"
#include "common/frame_builder.hpp"
#include "xpbd/constraints.hpp"
#include "xpbd/lines/line_layout.hpp"
#include "xpbd/time/integrator.hpp"

// Shared by lines and chains: constants of a substep, and dispatches whose workgroups synchronise at a grid barrier.

namespace clothbench::pbd_gpu {

/// Maximum polls of a grid barrier before it times out, while loading (GPU about 10 ms, CPU 50 ms) and in a frame (1 s,
/// 3 s). A poll takes about 0.5 us on a GPU and 3 ns on a CPU.
struct TimeoutPolls {
  std::uint32_t at_loading, in_a_frame;
};
inline TimeoutPolls timeout_polls(const vulkan::Device& d) {
  return d.is_software() ? TimeoutPolls{1u << 24, 1u << 30} : TimeoutPolls{1u << 14, 1u << 21};
}

/// Gravity, damping and the step of LineConstants or ChainConstants.
template <class Constants>
Constants step_constants(const FrameBuilder& frame, const TimeStep& step) {
  const Scene& s = frame.scene();
  const double h = step.implicit_h_s, gain = h * step.force_scale;
  const Vec3 g = s.gravity_m_per_s2;
  const auto f = [](double value) { return static_cast<float>(value); };
  Constants c{};
  c.gravity_h = {f(g[0] * gain), f(g[1] * gain), f(g[2] * gain), f(tether_spread_m(s))};
  c.h = f(h);
  c.damping_fraction = f(step.damping_fraction);
  c.history_weight = f(step.history_weight);
  c.per_h = f(1 / h);
  c.timeout_polls = timeout_polls(*frame.device()).in_a_frame;
  return c;
}

/// True if the device runs all workgroups of this kernel at once (grid_barrier.glsl) and tuning.device_barrier allows
/// it. Vulkan does not guarantee it, so a trial dispatch without work (all constants 0) has to pass a barrier over all
/// workgroups. With "always" a failed trial is an Error.
template <class Constants>
bool runs_at_once(const FrameBuilder& frame, const std::string& kernel_name, std::vector<std::uint32_t> specialization,
                  std::uint32_t threads, vulkan::Groups groups) {
  const std::string wanted = frame.tuning()["device_barrier"];
  const std::shared_ptr<vulkan::Device>& device = frame.device();
  if (!(wanted == "always" || (wanted == "auto" && device->is_discrete()))) return false;
  constexpr double kTimeout_s = 60;  // a longer trial means that the device is shared or faulty: an error in both cases
  const vulkan::Buffer barrier_counter(device, "meeting", 8, vulkan::Buffer::Place::Device);
  vulkan::Buffer zeros(device, "meeting (initial)", 8, vulkan::Buffer::Place::Host),
      timed_out(device, "timed out", 4, vulkan::Buffer::Place::Host);
  std::memset(zeros.mapped(), 0, 8);
  std::memset(timed_out.mapped(), 0, 4);
  specialization[0] = threads;
  const vulkan::Kernel kernel(device, kernel_name, shader(kernel_name), specialization,
                              frame.buffers_with({{BIND_BARRIER, &barrier_counter}, {BIND_TIMED_OUT, &timed_out}}),
                              sizeof(Constants));
  vulkan::Program program(device);
  program.copy(0, zeros, barrier_counter);
  Constants constants{};
  constants.timeout_polls = timeout_polls(*device).at_loading;
  program.dispatch(0, kernel, groups, constants);
  program.record(false);
  program.run(kTimeout_s);
  std::uint32_t failed = 0;
  std::memcpy(&failed, timed_out.mapped(), 4);
  if (failed != 0 && wanted == "always")
    throw Error("solver xpbd: setting tuning.device_barrier=always: expected a device that runs " +
                std::to_string(groups.x * groups.y) + " workgroups of " + std::to_string(threads) + " at once");
  return failed == 0;
}

/// Adds the buffers of the barrier: its counters, and the flag that is set if it times out.
inline void add_grid_barrier(FrameBuilder& frame) {
  frame.add_buffer(BIND_BARRIER, "meeting", 8);
  frame.set_timed_out(frame.add_host_buffer("timed out", 4, BIND_TIMED_OUT));
}

}  // namespace clothbench::pbd_gpu
