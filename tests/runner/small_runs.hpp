#pragma once
#include <functional>
#include <memory>

#include "runner/study_runner.hpp"
#include "scenario/load.hpp"
#include "with_folder.hpp"

namespace clothbench {

/// Steps `inner`, with the settings of the run.
using WrappedStep = std::function<StepStatus(ClothSolver& inner, const nlohmann::json& settings, const FrameInput&)>;

/// Another solver with its step replaced.
class Wrapped final : public ClothSolver {
 public:
  Wrapped(std::unique_ptr<ClothSolver> inner, nlohmann::json settings, WrappedStep step)
      : inner_(std::move(inner)), settings_(std::move(settings)), step_(std::move(step)) {}
  const SolverInfo& info() const override { return inner_->info(); }
  DeviceInfo device() const override { return inner_->device(); }
  void load(const Scene& s) override { inner_->load(s); }
  void reset() override { inner_->reset(); }
  StepStatus step(const FrameInput& f) override { return step_(*inner_, settings_, f); }
  void read_state(ClothState& s) const override { inner_->read_state(s); }
  FrameCost last_cost() const override { return inner_->last_cost(); }
  Plan plan() const override { return inner_->plan(); }

 private:
  std::unique_ptr<ClothSolver> inner_;
  nlohmann::json settings_;
  WrappedStep step_;
};

/// The ballistic solver with another step.
inline SolverEntry ballistic_with(const WrappedStep& step) {
  SolverEntry entry = find_solver("ballistic");
  entry.make = [make = entry.make, step](const nlohmann::json& settings, const DeviceOptions& device) {
    return std::make_unique<Wrapped>(make(nlohmann::json::object(), device), settings, step);
  };
  return entry;
}

/// Runs of a small scene in a folder of the test's own.
class SmallRuns : public WithFolder {
 protected:
  void SetUp() override {
    WithFolder::SetUp();
    options_.out = dir_;
  }

  static RunPlan plan_of(std::vector<RunSpec> group, int trials, int frames, double accuracy_s = 0.05) {
    RunPlan plan;
    plan.protocol = "test";
    plan.rules.trials = trials;
    plan.rules.frames = frames;
    plan.rules.warmup_s = 0;
    plan.rules.accuracy_duration_s = accuracy_s;
    plan.groups = {std::move(group)};
    return plan;
  }

  const Scene scene_ = load_scene("paper/gravity", {"cloth.grid=[4,4]"});
  RunOptions options_;
};

}  // namespace clothbench
