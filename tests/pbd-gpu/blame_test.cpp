// Runs of one process share a device: a validation message fails the right one.
#include <unistd.h>

#include <filesystem>

#include "gpu_fixture.hpp"
#include "runner/study_runner.hpp"
#include "scenario/load.hpp"

namespace clothbench::pbd_gpu {
namespace {

namespace fs = std::filesystem;

/// A device of its own, so that the messages are not held against another test.
const DeviceOptions kOwn{0, true};

/// Causes one message in its first frame.
class Noisy final : public ClothSolver {
 public:
  explicit Noisy(std::unique_ptr<ClothSolver> inner) : inner_(std::move(inner)) {}
  const SolverInfo& info() const override { return inner_->info(); }
  DeviceInfo device() const override { return inner_->device(); }
  void load(const Scene& s) override { inner_->load(s); }
  void reset() override { inner_->reset(); }
  StepStatus step(const FrameInput& f) override {
    const StepStatus status = inner_->step(f);
    if (!std::exchange(noisy_, false)) return status;
    vulkan::Device::get(kOwn)->note_message("planted");
    return status;
  }
  void read_state(ClothState& s) const override { inner_->read_state(s); }
  FrameCost last_cost() const override { return inner_->last_cost(); }
  Plan plan() const override { return inner_->plan(); }
  int validation_messages() const override { return inner_->validation_messages(); }

 private:
  std::unique_ptr<ClothSolver> inner_;
  bool noisy_ = true;
};

TEST_F(Gpu, OnlyTheRunThatCausedMessagesIsAFault) {
  const auto device = vulkan::Device::get(kOwn);
  ASSERT_NE(device, device_);
  const Scene scene = load_scene("paper/gravity", {"cloth.grid=[4,4]"});
  const SolverEntry& clean = find_solver("xpbd");
  SolverEntry noisy = clean, noisy_twin = clean;
  noisy.make = [&](const nlohmann::json& s, const DeviceOptions& d) -> std::unique_ptr<ClothSolver> {
    if (s.at("stage_times") == true) return clean.make(s, d);
    return std::make_unique<Noisy>(clean.make(s, d));
  };
  noisy_twin.make = [&](const nlohmann::json& s, const DeviceOptions& d) -> std::unique_ptr<ClothSolver> {
    if (s.at("stage_times") == false) return clean.make(s, d);
    return std::make_unique<Noisy>(clean.make(s, d));
  };
  const nlohmann::json settings = complete_settings(clean.info, nlohmann::json::object());
  RunPlan plan;
  plan.protocol = "test";
  plan.rules.trials = 1;
  plan.rules.frames = 3;
  plan.rules.warmup_s = 0;
  plan.rules.accuracy_duration_s = 0.05;
  // Runs of a group are loaded before any of them is timed; those of the next group come after all messages.
  plan.groups = {{{&scene, &noisy, settings, "noisy"},
                  {&scene, &clean, settings, "beside"},
                  {&scene, &noisy_twin, settings, "noisy-twin"}},
                 {{&scene, &clean, settings, "after"}}};
  RunOptions options;
  options.out = fs::temp_directory_path() / ("clothbench-blame-" + std::to_string(getpid()));
  options.device = kOwn;
  fs::create_directories(options.out);
  const RunResult result = execute_runs(plan, options);
  fs::remove_all(options.out);
  const std::string run = scene.name + "__xpbd__";
  EXPECT_EQ(result.faults, (std::vector<std::string>{run + "noisy: 1 validation messages",
                                                     run + "noisy-twin: 1 validation messages"}));
  EXPECT_EQ(result.validation_messages, 2);
}

}  // namespace
}  // namespace clothbench::pbd_gpu
