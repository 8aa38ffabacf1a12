#pragma once
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "base/json_text.hpp"
#include "clothbench/solver.hpp"
#include "common/gpu_types.h"
#include "vulkan/program.hpp"

namespace clothbench::pbd_gpu {

inline constexpr std::uint32_t kGroupSize = 64;

/// Code of a kernel. `name`: its file's name plus the variant's suffix in CMakeLists.txt. Throws Error if not found.
vulkan::SpirV shader(const std::string& name);

/// A kernel and the stage to which its dispatches belong.
struct FrameKernel {
  int stage;
  std::uint32_t group_size;
  std::vector<std::uint32_t> counting;  ///< its code with byte counters; empty if bytes are not counted
  vulkan::Kernel kernel;
};

/// Why a buffer does not fit a device: it is larger than the device's limit for one buffer, or all buffers together are
/// larger than its memory. Empty if it fits.
std::string why_no_room(const std::string& name, std::uint64_t bytes, std::uint64_t all_B, std::uint64_t largest_B,
                        std::uint64_t memory_B);

/// Buffers, stages, kernels, plan, and the repeatedly submitted frame that a solver and its parts build for a scene.
/// With the setting `count_bytes`, kernels count the bytes that they load and store.
class FrameBuilder {
 public:
  FrameBuilder(const nlohmann::json& settings, const DeviceOptions& device);
  FrameBuilder(const FrameBuilder&) = delete;
  FrameBuilder& operator=(const FrameBuilder&) = delete;

  const Scene& scene() const { return *scene_; }
  const nlohmann::json& settings() const { return settings_; }
  const nlohmann::json& tuning() const { return settings_[kTuning]; }
  const std::shared_ptr<vulkan::Device>& device() const { return device_; }

  static constexpr int kUnbound = -1;
  /// Adds a device buffer, which `reset` fills with `initial` followed by zeros. Kernels refer to it by its number
  /// (BIND_..., gpu_types.h). If it does not fit, throws Error with the scene, the needed size and the device's limit.
  const vulkan::Buffer& add_buffer(int binding, const std::string& name, std::uint64_t bytes,
                                   const void* initial = nullptr, std::size_t initial_bytes = 0);
  template <class T>
  const vulkan::Buffer& add_buffer(int binding, const std::string& name, const std::vector<T>& items) {
    static_assert(std::is_trivially_copyable_v<T>);
    return add_buffer(binding, name, items.size() * sizeof(T), items.data(), items.size() * sizeof(T));
  }
  /// A buffer in host memory, filled with zeros.
  const vulkan::Buffer& add_host_buffer(const std::string& name, std::uint64_t bytes, int binding = kUnbound);

  int add_stage(const std::string& name, FeatureSet serves);
  /// Adds kernel `name`, bound to the buffers that its code declares; `own` take precedence over the buffers of
  /// add_buffer. A declared buffer that the scene lacks is never accessed, and the positions are bound in its place.
  /// `constants`: specialization constants by number.
  const FrameKernel* add_kernel(int stage, const std::string& name, std::uint32_t push_bytes,
                                std::vector<std::uint32_t> constants = {}, std::uint32_t group_size = kGroupSize,
                                const vulkan::Buffers& own = {});
  vulkan::Buffers buffers_with(vulkan::Buffers own) const;
  void disable(const std::string& what, const std::string& why, const std::string& no_parameter = "") {
    plan_.left_out.push_back({what, why, no_parameter});
  }
  void set_contact_margins(std::vector<double> margins_m) { plan_.contact_margins_m = std::move(margins_m); }
  /// A word in host memory that a kernel sets if a barrier over all workgroups times out. The frame is then TimedOut.
  void set_timed_out(const vulkan::Buffer& word) { timed_out_ = &word; }

  template <class Constants>
  void dispatch(const FrameKernel& k, std::uint64_t items, const Constants& constants) {
    dispatch_groups(k, vulkan::groups_for(items, k.group_size), constants);
  }
  template <class Constants>
  void dispatch_groups(const FrameKernel& k, vulkan::Groups groups, const Constants& constants) {
    frame_->dispatch(k.stage, k.kernel, groups, constants);
  }
  void copy(int stage, const vulkan::Buffer& from, const vulkan::Buffer& to);

 protected:
  void begin(const Scene&);
  void require_room(const std::string& name, std::uint64_t bytes) const;

  const nlohmann::json settings_;
  std::shared_ptr<vulkan::Device> device_;
  const Scene* scene_ = nullptr;
  Plan plan_;
  const vulkan::Buffer* timed_out_ = nullptr;
  // Programs and kernels refer to buffers, so they are declared after them and destroyed before them.
  std::vector<std::unique_ptr<vulkan::Buffer>> buffers_;
  vulkan::Buffers bound_;
  /// Counters of all stages (four words each; vulkan/count_bytes.cpp): on the device, their copy on the host, and zeros
  /// that reset them. Null unless bytes are counted.
  const vulkan::Buffer *counters_ = nullptr, *counted_ = nullptr, *zeros_ = nullptr;
  std::vector<double> copied_B_;  ///< bytes copied per frame, by stage
  std::vector<std::unique_ptr<FrameKernel>> kernels_;
  std::unique_ptr<vulkan::Program> frame_, upload_, download_;
};

/// Inverse masses [1/kg] of the scene's vertices at the start, 0 if pinned or attached.
std::vector<float> inverse_masses(const Scene&);

}  // namespace clothbench::pbd_gpu
