#pragma once
#include <atomic>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "clothbench/solver.hpp"
#include "colliders.hpp"
#include "pbd_shared.h"
#include "shaders.hpp"
#include "vulkan/program.hpp"

namespace clothbench::pbd_gpu {

inline constexpr std::uint32_t kGroupSize = 64;

class XpbdContact;
class XpbdSelfContact;
class Lines;
class Chains;

/// Bytes of one dispatch, computed from the scene and the kernel's loops (no contention retries of atomics).
struct Traffic {
  double read_B = 0, write_B = 0;
};

/// What a buffer starts with.
template <class T>
std::vector<std::uint8_t> bytes_of(const std::vector<T>& items) {
  std::vector<std::uint8_t> bytes(items.size() * sizeof(T));
  std::memcpy(bytes.data(), items.data(), bytes.size());
  return bytes;
}

/// What both methods share: device, buffers, one recorded frame submitted again and again, costs. A method fills in
/// its buffers and its frame.
class GpuSolver : public ClothSolver {
 public:
  GpuSolver(SolverInfo info, const nlohmann::json& settings, const DeviceOptions& device, bool count_bytes);

  const SolverInfo& info() const override { return info_; }
  DeviceInfo device() const override { return device_->info(); }
  void load(const Scene& scene) override;
  void reset() override;
  StepStatus step(const FrameInput&) override;
  int frames_in_flight() const override;
  StepStatus run_frames(const std::vector<FrameInput>&) override;
  void read_state(ClothState&) const override;
  bool restart(const ClothState&) override;
  FrameCost last_cost() const override;
  Plan plan() const override;
  int validation_messages() const override { return *messages_; }

  /// Bytes each stage's instrumented kernels counted since the last call; needs `count_bytes`.
  std::vector<Traffic> counted();
  /// Positions as the device holds them, of every copy or layer of the cloth, relative to the method's origin; for
  /// tests.
  std::vector<float> device_positions() const;
  /// What read_state reads positions from, for drawing without reading back: the scene's vertices first, a vec4 each,
  /// relative to `origin_m()`. Of a loaded solver.
  const vulkan::Buffer& position_buffer() const { return *position_; }
  const Vec3& origin_m() const { return origin_m_; }
  /// What is submitted for set-up, a frame and reading back, for the test of the barriers.
  const vulkan::Program& upload_program() const { return *upload_; }
  const vulkan::Program& frame_program() const { return *frame_; }
  const vulkan::Program& download_program() const { return *download_; }

 protected:
  using vec4s = std::vector<vec4>;

  /// Buffers and kernels of this scene.
  virtual void build() = 0;
  /// The frame of `dt_s` into program().
  virtual void record_frame(double dt_s) = 0;

  const Scene& scene() const { return *scene_; }
  const nlohmann::json& settings() const { return settings_; }
  const nlohmann::json& tuning() const { return settings_[kTuning]; }
  /// For this scene alone: a setting that it cannot be run with.
  void override_setting(const char* name, const nlohmann::json& value, const std::string& why) {
    if (settings_.at(name) == value) return;
    settings_[name] = value;
    leave_out(std::string("setting ") + name, why);
  }
  vulkan::Device& vulkan_device() const { return *device_; }

  /// A device buffer that `reset` fills with these bytes (zeros beyond them).
  vulkan::Buffer& add_buffer(const std::string& name, std::uint64_t bytes, std::vector<std::uint8_t> initial = {});
  vulkan::Buffer& add_vec4_buffer(const std::string& name, const vec4s& initial);
  vulkan::Buffer& add_host_buffer(const std::string& name, std::uint64_t bytes);
  /// Read back by read_state: the first `vertex_count` vec4 of each.
  void set_state(const vulkan::Buffer& position, const vulkan::Buffer& velocity, Vec3 origin_m);

  /// A word in host memory that a kernel sets where workgroups waited for one another in vain: such a frame is
  /// TimedOut.
  void set_missed(const vulkan::Buffer& word) { missed_ = &word; }

  /// `at_least`: how much its kernels read depends on how the cloth lies; what is declared is what every frame reads.
  int add_stage(const std::string& name, FeatureSet serves, bool at_least = false);
  vulkan::Kernel& add_kernel(int stage, const Shader& shader, std::vector<vulkan::Binding> bindings,
                             std::uint32_t push_bytes, std::vector<std::uint32_t> specialization = {},
                             std::uint32_t group_size = kGroupSize);
  /// What the scene has of colliders and grips, relative to `origin_m`; their stages come where these are called.
  void add_colliders(Vec3 origin_m, bool keep_start);
  void add_grips(Vec3 origin_m, std::uint32_t layers);
  ColliderBuffers* colliders() { return colliders_.get(); }  ///< null where the scene has none
  GripBuffer* grips() { return grips_.get(); }               ///< null where the scene has none
  /// Inverse masses of the scene's vertices in this frame [1/kg], 0 where pinned or held. record_frame is called again,
  /// for the bytes alone, when they change.
  const std::vector<float>& inverse_mass_now() const { return inverse_mass_now_; }

  void leave_out(const std::string& what, const std::string& why) { plan_.left_out.push_back({what, why}); }

  template <class Constants>
  void dispatch(int stage, const vulkan::Kernel& kernel, std::uint64_t items, const Constants& constants,
                Traffic traffic) {
    dispatch_groups(stage, kernel, vulkan::groups_for(items, kGroupSize), constants, traffic);
  }
  template <class Constants>
  void dispatch_groups(int stage, const vulkan::Kernel& kernel, vulkan::Groups groups, const Constants& constants,
                       Traffic traffic) {
    if (!only_counting_) frame_->dispatch(stage, kernel, groups, constants);
    plan_.stages[static_cast<std::size_t>(stage)].read_B += traffic.read_B;
    plan_.stages[static_cast<std::size_t>(stage)].write_B += traffic.write_B;
  }
  void copy(int stage, const vulkan::Buffer& from, const vulkan::Buffer& to);

 private:
  friend ColliderBuffers;
  friend XpbdContact;
  friend XpbdSelfContact;
  friend Lines;
  friend Chains;
  friend GripBuffer;
  friend class PaperContact;
  struct Initial {
    const vulkan::Buffer* target;
    std::unique_ptr<vulkan::Buffer> staging;
  };
  void record(double dt_s);
  void count(double dt_s);
  void update_inverse_masses();
  StepStatus run(vulkan::Program& program) const;
  StepStatus unless_missed(StepStatus status) const;
  /// Messages of the layer are this solver's until another uses the device.
  void take_messages() const { device_->count_messages_in(messages_); }
  template <class Fn>
  StepStatus guarded(Fn submit_or_wait) const;
  double patience_s() const;

  const SolverInfo info_;
  const nlohmann::json given_settings_;
  nlohmann::json settings_;  ///< the same, but for what the scene does not allow
  const bool count_bytes_;
  std::shared_ptr<vulkan::Device> device_;
  const std::shared_ptr<std::atomic<int>> messages_ = std::make_shared<std::atomic<int>>(0);
  const Scene* scene_ = nullptr;
  double dt_s_ = 0;
  StepStatus ready_ = StepStatus::Ok;  ///< of the last reset
  StepStatus last_ = StepStatus::Ok;   ///< of the last reset or step
  Plan plan_;
  Vec3 origin_m_{};
  std::vector<float> inverse_mass_now_;
  bool only_counting_ = false;
  const vulkan::Buffer* missed_ = nullptr;
  // Programs and kernels refer to buffers, so they are declared, and destroyed, in this order.
  std::vector<std::unique_ptr<vulkan::Buffer>> buffers_;
  std::vector<Initial> initials_;
  std::vector<vulkan::Buffer*> counters_;  ///< one a stage
  const vulkan::Buffer *position_ = nullptr,
                       *velocity_ = nullptr;  ///< what read_position_ and read_velocity_ are copies of
  std::unique_ptr<vulkan::Buffer> read_position_, read_velocity_;
  std::vector<std::unique_ptr<vulkan::Kernel>> kernels_;
  std::unique_ptr<ColliderBuffers> colliders_;
  std::unique_ptr<GripBuffer> grips_;
  std::unique_ptr<vulkan::Program> frame_, upload_, download_;
};

/// Inverse masses [1/kg] of the scene's vertices at the start, 0 where pinned or gripped.
std::vector<float> inverse_masses(const Scene&);

/// Throw Error naming the setting unless it is from `low` to `high`, or one of `known`.
void require_between(const char* solver, const nlohmann::json& settings, const char* key, double low, double high);
void require_one_of(const char* solver, const nlohmann::json& settings, const char* key,
                    const std::vector<nlohmann::json>& known);

std::unique_ptr<GpuSolver> make_paper(const nlohmann::json& settings, const DeviceOptions&, bool count_bytes = false);
std::unique_ptr<GpuSolver> make_xpbd(const nlohmann::json& settings, const DeviceOptions&, bool count_bytes = false);
SolverInfo paper_info();
SolverInfo xpbd_info();
double paper_free_fall_m(const Scene&, const nlohmann::json& settings, int frames);
double xpbd_free_fall_m(const Scene&, const nlohmann::json& settings, int frames);

}  // namespace clothbench::pbd_gpu
