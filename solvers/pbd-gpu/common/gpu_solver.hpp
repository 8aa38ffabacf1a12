#pragma once
#include <atomic>
#include <memory>
#include <vector>

#include "clothbench/solver.hpp"
#include "common/colliders.hpp"
#include "common/frame_builder.hpp"

namespace clothbench::pbd_gpu {

/// The part that both solvers share: a recorded frame that is submitted repeatedly, read-back of the state, and costs.
/// A derived solver adds its buffers and records its frame.
class GpuSolver : public ClothSolver, protected FrameBuilder {
 public:
  GpuSolver(SolverInfo info, const nlohmann::json& settings, const DeviceOptions& device);

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
  Plan plan() const override { return plan_; }
  int validation_messages() const override { return *messages_; }

  /// The buffer that read_state reads positions from, for rendering without read-back: the scene's vertices first, a
  /// vec4 each, relative to `origin_m()`. The solver must be loaded. A frame may replace it.
  const vulkan::Buffer& position_buffer() const { return *position_; }
  const Vec3& origin_m() const { return origin_m_; }
  /// The programs of set-up, a frame and reading back, for the test of the barriers.
  const vulkan::Program& upload_program() const { return *upload_; }
  const vulkan::Program& frame_program() const { return *frame_; }
  const vulkan::Program& download_program() const { return *download_; }

 protected:
  FrameBuilder& frame() { return *this; }

  /// Adds the buffers and kernels of this scene.
  virtual void build() = 0;
  /// Records the dispatches and copies of a frame of `dt_s` after one of `last_dt_s`. 0: no frame came before, or the
  /// state was set or a vertex attached or released after it. Without BDF2, `last_dt_s` is always `dt_s`.
  virtual void record_frame(double dt_s, double last_dt_s) = 0;
  /// Updates the number of substeps. Called once before each frame.
  virtual void update_substep_count(double /*dt_s*/) {}
  /// What else the recorded frame depends on. Frames with equal numbers are recorded once.
  virtual std::vector<double> frame_key() const { return {}; }
  bool reads_back_ = false;  ///< the host reads each frame's result before it submits the next: one frame in flight
  bool uses_bdf2_ = false;   ///< a frame's first substep depends on the last frame's

  /// Adds the buffers of positions (relative to `origin_m`, so that distant scenes lose no digits) and velocities;
  /// .w of both: inverse mass. `layers`: copies of the vertices; read_state reads back the first one.
  void add_state(const std::vector<double>& start, const std::vector<float>& inverse_mass, Vec3 origin_m, int layers);
  /// Add the scene's colliders and grips, if any, relative to `origin_m`. Their stages come after those already added.
  void add_colliders(Vec3 origin_m, bool as_convex_shapes);
  void add_grips(Vec3 origin_m, std::uint32_t layers);
  const vulkan::Buffer& velocity_buffer() const { return *velocity_; }
  StepStatus run(vulkan::Program& program) const;
  /// The part of step() after the motion of colliders and attached vertices is written.
  StepStatus run_frame(double dt_s);
  ColliderBuffers* colliders() { return colliders_.get(); }  ///< null if the scene has none
  GripBuffer* grips() { return grips_.get(); }               ///< null if the scene has none

 private:
  void record(double dt_s, double last_dt_s);
  void prepare(double dt_s);
  StepStatus unless_timed_out(StepStatus status) const;
  /// Counts messages of the validation layer for this solver until another solver uses the device.
  void take_messages() const { device_->count_messages_in(messages_); }
  template <class Fn>
  StepStatus guarded(Fn submit_or_wait) const;
  double timeout_s() const;

  const SolverInfo info_;
  const std::shared_ptr<std::atomic<int>> messages_ = std::make_shared<std::atomic<int>>(0);
  /// Recorded frames that are not the current one. Recording can take longer than the frame itself.
  struct KeptFrame {
    std::unique_ptr<vulkan::Program> program;
    std::vector<double> copied_B;
  };
  std::map<std::vector<double>, KeptFrame> kept_;
  std::vector<double> key_;            ///< of the current frame: both durations and frame_key()
  double dt_s_ = 0;                    ///< duration of the recorded frame
  double done_dt_s_ = 0;               ///< duration of the last frame; 0: BDF2 has no frame to continue from
  StepStatus ready_ = StepStatus::Ok;  ///< status of the last reset
  StepStatus last_ = StepStatus::Ok;   ///< status of the last reset or step
  Vec3 origin_m_{};
  const vulkan::Buffer *position_ = nullptr, *velocity_ = nullptr, *read_position_ = nullptr, *read_velocity_ = nullptr;
  std::unique_ptr<ColliderBuffers> colliders_;
  std::unique_ptr<GripBuffer> grips_;
};

/// Throw Error naming the setting unless it is from `low` to `high`, or one of `known`.
void require_between(const char* solver, const nlohmann::json& settings, const char* key, double low, double high);
void require_one_of(const char* solver, const nlohmann::json& settings, const char* key,
                    const std::vector<nlohmann::json>& known);

std::unique_ptr<GpuSolver> make_paper(const nlohmann::json& settings, const DeviceOptions&);
std::unique_ptr<GpuSolver> make_xpbd(const nlohmann::json& settings, const DeviceOptions&);
SolverInfo paper_info();
SolverInfo xpbd_info();
/// Throws Error naming a setting that is not allowed.
void check_xpbd_settings(const nlohmann::json& settings);
double paper_free_fall_m(const Scene&, const nlohmann::json& settings, int frames);
double xpbd_free_fall_m(const Scene&, const nlohmann::json& settings, int frames);

}  // namespace clothbench::pbd_gpu
