#pragma once
// Solvers that tests make themselves.
#include <cstdlib>
#include <memory>
#include <string>

#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"
#include "runner/solver_run.hpp"

namespace clothbench {

/// A cloth that stays where it starts; a test overrides the functions that it is about.
class StillSolver : public ClothSolver {
 public:
  explicit StillSolver(SolverInfo info) : info_(std::move(info)) {}
  const SolverInfo& info() const override { return info_; }
  DeviceInfo device() const override { return {"CPU", "", "C++20", false, "{}"}; }
  void load(const Scene& scene) override {
    scene_ = &scene;
    reset();
  }
  void reset() override {
    state_ = {initial_positions(*scene_), std::vector<double>(3 * scene_->cloth.vertex_count(), 0)};
  }
  StepStatus step(const FrameInput&) override { return StepStatus::Ok; }
  void read_state(ClothState& out) const override { out = state_; }
  FrameCost last_cost() const override { return {kMissing, {kMissing}, {kMissing}, {kMissing}}; }
  Plan plan() const override {
    Plan p;
    p.stages = {{"stay", {}, 0, kMissing, kMissing}};
    return p;
  }

 protected:
  SolverInfo info_;
  const Scene* scene_ = nullptr;
  ClothState state_;
};

/// Forwards all calls to another solver; a test overrides the functions that it changes.
class WrappedSolver : public ClothSolver {
 public:
  explicit WrappedSolver(std::unique_ptr<ClothSolver> inner) : inner_(std::move(inner)) {}
  const SolverInfo& info() const override { return inner_->info(); }
  DeviceInfo device() const override { return inner_->device(); }
  void load(const Scene& scene) override { inner_->load(scene); }
  void reset() override { inner_->reset(); }
  StepStatus step(const FrameInput& input) override { return inner_->step(input); }
  void read_state(ClothState& out) const override { inner_->read_state(out); }
  FrameCost last_cost() const override { return inner_->last_cost(); }
  Plan plan() const override { return inner_->plan(); }

 protected:
  std::unique_ptr<ClothSolver> inner_;
};

inline FeatureSet all_features() {
  FeatureSet out;
  for (std::size_t i = 0; i < kFeatureCount; ++i) out.add(static_cast<Feature>(i));
  return out;
}

/// An untimed pass over a whole scene.
inline AccuracyPass whole_pass(SolverRun& run, const Scene& scene) {
  TrialRules rules;
  rules.accuracy_duration_s = scene.time.duration_s;
  return run.run_accuracy(rules);
}

/// Whether an error reports a missing device and CLOTHBENCH_ALLOW_NO_DEVICE=1 allows tests to do without one.
inline bool may_lack_device(const Error& e) {
  const char* allowed = std::getenv("CLOTHBENCH_ALLOW_NO_DEVICE");
  return e.code() == ExitCode::NoDevice && allowed != nullptr && std::string(allowed) == "1";
}

}  // namespace clothbench
