#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// Positions of the cloth at the end of frame `frame` (0 = initial state), from those at the start.
using Path = std::function<void(int frame, std::vector<double>& position)>;

/// A solver that gives its cloth a prescribed motion, whatever is in the way, so that the values of metrics are known.
class PrescribedSolver final : public ClothSolver {
 public:
  PrescribedSolver(SolverInfo info, Path path, std::vector<double> contact_margins_m = {})
      : info_(std::move(info)), path_(std::move(path)), margins_(std::move(contact_margins_m)) {}

  const SolverInfo& info() const override { return info_; }
  DeviceInfo device() const override { return {"CPU", "", "C++20", false, "{}"}; }
  void load(const Scene& scene) override { start_ = initial_positions(scene); }
  void reset() override { frame_ = 0; }
  StepStatus step(const FrameInput&) override {
    ++frame_;
    return StepStatus::Ok;
  }
  void read_state(ClothState& out) const override {
    out.position = start_;
    out.velocity.assign(start_.size(), 0);
    path_(frame_, out.position);
  }
  FrameCost last_cost() const override { return {kMissing, {kMissing}, {kMissing}, {kMissing}}; }
  Plan plan() const override {
    Plan p;
    p.stages = {{"follow", {}, 0, kMissing, kMissing}};
    p.contact_margins_m = margins_;
    return p;
  }

 private:
  SolverInfo info_;
  Path path_;
  std::vector<double> margins_;
  std::vector<double> start_;
  int frame_ = 0;
};

inline SolverEntry prescribed(const Path& path, const std::vector<double>& contact_margins_m = {}) {
  SolverInfo info;
  info.name = "prescribed";
  info.folder = "tests";
  info.precision = "float64";
  for (std::size_t i = 0; i < kFeatureCount; ++i) info.ignores.add(static_cast<Feature>(i));
  return {info,
          [info, path, contact_margins_m](const nlohmann::json&, const DeviceOptions&) {
            return std::make_unique<PrescribedSolver>(info, path, contact_margins_m);
          },
          [](const Scene&, const nlohmann::json&, int) { return 0.0; }};
}

/// The whole cloth moves by `by(frame)` along y.
inline Path lifted(std::function<double(int)> by) {
  return [by = std::move(by)](int frame, std::vector<double>& x) {
    for (std::size_t k = 1; k < x.size(); k += 3) x[k] += by(frame);
  };
}

}  // namespace clothbench
