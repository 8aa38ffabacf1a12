#include "common/gpu_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "clothbench/record.hpp"

namespace clothbench::pbd_gpu {

/// A frame that takes longer has timed out. Concurrent processes share a GPU; software devices are slow.
constexpr double kTimeout_s = 30, kSoftwareTimeout_s = 300;

/// Recorded frames with other numbers of substeps that are kept.
constexpr std::size_t kMaxKeptFrames = 64;

/// An application shows one frame while the next is computed, so it has two.
constexpr int kFramesInFlight = 2;

void require_between(const char* solver, const nlohmann::json& settings, const char* key, double low, double high) {
  if (const auto x = settings[key].get<double>(); !(x >= low && x <= high))
    throw Error(fmt::format("solver {}: setting {}: expected {} to {}; found {}", solver, key, low, high, x));
}

void require_one_of(const char* solver, const nlohmann::json& settings, const char* key,
                    const std::vector<nlohmann::json>& known) {
  if (std::find(known.begin(), known.end(), settings[key]) == known.end())
    throw Error(fmt::format("solver {}: setting {}: expected one of {}; found {}", solver, key,
                            dump(nlohmann::json(known)), dump(settings[key])));
}

GpuSolver::GpuSolver(SolverInfo info, const nlohmann::json& settings, const DeviceOptions& device)
    : FrameBuilder(settings, device), info_(std::move(info)) {
  take_messages();
}

void GpuSolver::add_state(const std::vector<double>& start, const std::vector<float>& inverse_mass, Vec3 origin_m,
                          int layers) {
  const std::vector<double> start_velocity = initial_velocities(scene());
  std::vector<vec4> position, velocity;
  for (int layer = 0; layer < layers; ++layer)
    for (std::size_t i = 0; i < inverse_mass.size(); ++i) {
      const float w = inverse_mass[i];
      const auto at = [&](std::size_t k) { return static_cast<float>(start[3 * i + k] - origin_m[k]); };
      const auto speed = [&](std::size_t k) { return w > 0 ? static_cast<float>(start_velocity[3 * i + k]) : 0.0f; };
      position.push_back({at(0), at(1), at(2), w});
      velocity.push_back({speed(0), speed(1), speed(2), w});
    }
  origin_m_ = origin_m;
  position_ = &add_buffer(BIND_POSITIONS, "positions", position);
  velocity_ = &add_buffer(BIND_VELOCITIES, "velocities", velocity);
  const std::uint64_t bytes = scene().cloth.vertex_count() * sizeof(vec4);
  read_position_ = &add_host_buffer("read position", bytes);
  read_velocity_ = &add_host_buffer("read velocity", bytes);
  download_->copy(0, *position_, *read_position_);
  download_->copy(0, *velocity_, *read_velocity_);
}

void GpuSolver::add_colliders(Vec3 origin_m, bool as_convex_shapes) {
  if (!scene_->colliders.empty())
    colliders_ = std::make_unique<ColliderBuffers>(frame(), *scene_, origin_m, as_convex_shapes);
}

void GpuSolver::add_grips(Vec3 origin_m, std::uint32_t layers) {
  if (!scene_->grips.vertices.empty()) grips_ = std::make_unique<GripBuffer>(frame(), *scene_, origin_m, layers);
}

void GpuSolver::load(const Scene& scene) {
  take_messages();
  kept_.clear();
  key_.clear();
  begin(scene);
  build();
  upload_->record(false);
  download_->record(false);
  record(scene.time.dt(), scene.time.dt());
  reset();
}

void GpuSolver::record(double dt_s, double last_dt_s) {
  std::vector<double> key = frame_key();
  key.insert(key.end(), {dt_s, last_dt_s});
  if (key == key_) return;
  // Other durations than the scene's seldom come twice.
  if (!key_.empty() && dt_s_ == scene_->time.dt()) kept_[key_] = {std::move(frame_), copied_B_};
  if (kept_.size() > kMaxKeptFrames) kept_.erase(kept_.begin());
  dt_s_ = dt_s;
  key_ = key;
  if (const auto known = kept_.extract(key); known) {
    frame_ = std::move(known.mapped().program);
    copied_B_ = known.mapped().copied_B;
    return;
  }
  if (frame_)
    frame_->clear();
  else
    frame_ = std::make_unique<vulkan::Program>(device_);
  copied_B_.assign(plan_.stages.size(), 0);
  if (counters_ != nullptr) frame_->copy(0, *zeros_, *counters_);
  record_frame(dt_s, last_dt_s);
  if (counters_ != nullptr) frame_->copy(0, *counters_, *counted_);
  for (std::size_t s = 0; s < plan_.stages.size() && last_dt_s == dt_s; ++s)  // the plan describes steady frames
    plan_.stages[s].dispatches = frame_->dispatches(static_cast<int>(s));
  frame_->record(settings_.value("stage_times", false));
}

/// Records the next frame unless its commands are recorded already.
void GpuSolver::prepare(double dt_s) {
  const double last_dt_s = uses_bdf2_ ? done_dt_s_ : dt_s;
  update_substep_count(dt_s);
  record(dt_s, last_dt_s);
}

/// Converts a failed Vulkan call to the status of a step.
template <class Fn>
StepStatus GpuSolver::guarded(Fn submit_or_wait) const {
  try {
    submit_or_wait();
  } catch (const vulkan::Failure& failure) {
    if (failure.result() == VK_TIMEOUT) return StepStatus::TimedOut;
    if (failure.result() == VK_ERROR_DEVICE_LOST) {
      device_->mark_lost();
      return StepStatus::DeviceLost;
    }
    throw;
  }
  return StepStatus::Ok;
}

double GpuSolver::timeout_s() const { return device_->is_software() ? kSoftwareTimeout_s : kTimeout_s; }

StepStatus GpuSolver::run(vulkan::Program& program) const {
  return guarded([&] { program.run(timeout_s()); });
}

void GpuSolver::reset() {
  take_messages();
  done_dt_s_ = 0;
  if (colliders_) colliders_->reset();
  if (grips_) grips_->reset();
  if (timed_out_ != nullptr) std::memset(timed_out_->mapped(), 0, sizeof(std::uint32_t));
  // The next step, or a read of the state before that step, reports a device that is lost here.
  ready_ = run(*upload_);
  last_ = StepStatus::Ok;
}

StepStatus GpuSolver::step(const FrameInput& frame) {
  take_messages();
  if (ready_ != StepStatus::Ok) return last_ = ready_;
  if (colliders_) colliders_->write(frame.motion);
  // A vertex that was just attached or released has no valid last substep, so BDF2 restarts.
  if (grips_ && grips_->write(frame.motion)) done_dt_s_ = 0;
  return run_frame(frame.dt_s);
}

StepStatus GpuSolver::run_frame(double dt_s) {
  prepare(dt_s);
  done_dt_s_ = dt_s;
  return last_ = unless_timed_out(run(*frame_));
}

StepStatus GpuSolver::unless_timed_out(StepStatus status) const {
  if (status != StepStatus::Ok || timed_out_ == nullptr) return status;
  std::uint32_t timed_out = 0;
  std::memcpy(&timed_out, timed_out_->mapped(), sizeof timed_out);
  return timed_out == 0 ? StepStatus::Ok : StepStatus::TimedOut;
}

/// Data that the host writes or reads every frame has a single buffer, so the previous frame must have finished.
int GpuSolver::frames_in_flight() const {
  const bool host_takes_part = grips_ != nullptr || reads_back_ ||
                               (colliders_ != nullptr && colliders_->written_each_frame()) ||
                               settings_.value("readback", "none") != "none";
  return host_takes_part ? 1 : kFramesInFlight;
}

StepStatus GpuSolver::run_frames(const std::vector<FrameInput>& frames) {
  take_messages();
  const bool alike = std::all_of(frames.begin(), frames.end(), [&](const FrameInput& f) { return f.dt_s == dt_s_; });
  if (!alike || frames_in_flight() == 1) return ClothSolver::run_frames(frames);
  if (ready_ != StepStatus::Ok) return ready_;
  if (uses_bdf2_ && done_dt_s_ != dt_s_ && !frames.empty()) {
    const StepStatus status = step(frames.front());
    if (status != StepStatus::Ok || frames.size() == 1) return status;
    return run_frames({frames.begin() + 1, frames.end()});
  }
  prepare(dt_s_);
  return last_ = unless_timed_out(guarded([&] {
           frame_->need_copies(kFramesInFlight);
           for (std::size_t k = 0; k < frames.size(); ++k) {
             frame_->wait(k % kFramesInFlight, timeout_s());
             frame_->submit(k % kFramesInFlight);
           }
           // Waits for the oldest first, so that last_cost is the last frame's.
           for (std::size_t k = frames.size(); k < frames.size() + kFramesInFlight; ++k)
             frame_->wait(k % kFramesInFlight, timeout_s());
         }));
}

void GpuSolver::read_state(ClothState& state) const {
  take_messages();
  const std::size_t n = scene_->cloth.vertex_count();
  state.position.assign(3 * n, kMissing);
  state.velocity.assign(3 * n, kMissing);
  if (run(*download_) != StepStatus::Ok) {
    // A lost device has no state. A loss that was not reported yet must throw here; otherwise undefined numbers would
    // count as the solver's state.
    if (last_ != StepStatus::Ok) return;
    throw Error("solver " + info_.name + ": the device was lost or timed out while its state was read",
                ExitCode::CheckFailed);
  }
  const auto* x = static_cast<const float*>(read_position_->mapped());
  const auto* v = static_cast<const float*>(read_velocity_->mapped());
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      state.position[3 * i + k] = origin_m_[k] + static_cast<double>(x[4 * i + k]);
      state.velocity[3 * i + k] = static_cast<double>(v[4 * i + k]);
    }
}

/// As after a reset, rounding errors of compensated sums are 0, and BDF2 and the number of substeps start anew.
bool GpuSolver::restart(const ClothState& state) {
  take_messages();
  const bool more_layers = position_->bytes() > read_position_->bytes();
  if (!scene_->motion.empty() || more_layers) return false;
  reset();
  // Reads back first: .w of the positions are the inverse masses.
  if (ready_ != StepStatus::Ok || run(*download_) != StepStatus::Ok) return false;
  auto* x = static_cast<float*>(read_position_->mapped());
  auto* v = static_cast<float*>(read_velocity_->mapped());
  for (std::size_t i = 0; i < scene_->cloth.vertex_count(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      x[4 * i + k] = static_cast<float>(state.position.at(3 * i + k) - origin_m_[k]);
      v[4 * i + k] = static_cast<float>(state.velocity.at(3 * i + k));
    }
  vulkan::Program put(device_);
  put.copy(0, *read_position_, *position_);
  put.copy(0, *read_velocity_, *velocity_);
  put.record(false);
  return run(put) == StepStatus::Ok;
}

FrameCost GpuSolver::last_cost() const {
  FrameCost cost;
  cost.device_s = frame_->device_s();
  cost.stage_device_s = frame_->stage_s(static_cast<int>(plan_.stages.size()));
  const auto* word = counted_ == nullptr ? nullptr : static_cast<const std::uint32_t*>(counted_->mapped());
  for (std::size_t k = 0; k < plan_.stages.size(); ++k) {
    const auto bytes = [&](std::size_t at) {
      return word == nullptr ? kMissing : copied_B_[k] + word[4 * k + at] + 0x1p32 * word[4 * k + at + 1];
    };
    cost.stage_read_B.push_back(bytes(0));
    cost.stage_write_B.push_back(bytes(2));
  }
  return cost;
}

}  // namespace clothbench::pbd_gpu

namespace clothbench {

void register_pbd_gpu(std::vector<SolverEntry>& out) {
  using namespace pbd_gpu;
  out.push_back({paper_info(), make_paper, paper_free_fall_m, vulkan::Device::list});
  out.push_back({xpbd_info(), make_xpbd, xpbd_free_fall_m, vulkan::Device::list});
}

}  // namespace clothbench
