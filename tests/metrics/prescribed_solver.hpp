#pragma once
#include <functional>
#include <vector>

#include "solvers.hpp"

namespace clothbench {

/// Positions of the cloth at the end of frame `frame` (0 = initial state), from those at the start.
using Path = std::function<void(int frame, std::vector<double>& position)>;

/// A solver that gives its cloth a prescribed motion, ignoring all obstacles, so that the values of metrics are known.
class PrescribedSolver final : public StillSolver {
 public:
  PrescribedSolver(SolverInfo info, Path path, std::vector<double> contact_margins_m = {})
      : StillSolver(std::move(info)), path_(std::move(path)), margins_(std::move(contact_margins_m)) {}

  void reset() override {
    StillSolver::reset();
    frame_ = 0;
  }
  StepStatus step(const FrameInput&) override {
    ++frame_;
    return StepStatus::Ok;
  }
  void read_state(ClothState& out) const override {
    out = state_;
    path_(frame_, out.position);
  }
  Plan plan() const override {
    Plan p = StillSolver::plan();
    p.contact_margins_m = margins_;
    return p;
  }

 private:
  Path path_;
  std::vector<double> margins_;
  int frame_ = 0;
};

inline SolverEntry prescribed(const Path& path, const std::vector<double>& contact_margins_m = {}) {
  SolverInfo info;
  info.name = "prescribed";
  info.folder = "tests";
  info.precision = "float64";
  info.ignores = all_features();
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
