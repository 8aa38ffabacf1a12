// Particles that only fall: the smallest complete backend. See README.md beside this file.

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {
namespace {

SolverInfo describe() {
  SolverInfo info;
  info.name = "ballistic";
  info.folder = "solvers/ballistic";
  info.summary =
      "particles that only fall: measures the overhead of the harness, and must fail every penetration check";
  info.version = "1";
  info.precision = "float64";
  for (std::size_t i = 0; i < kFeatureCount; ++i) info.ignores.add(static_cast<Feature>(i));
  return info;
}

class Ballistic final : public ClothSolver {
 public:
  const SolverInfo& info() const override { return info_; }
  DeviceInfo device() const override { return {"CPU", "", "C++20", false, "{}"}; }

  void load(const Scene& scene) override {
    scene_ = &scene;
    reset();
  }

  void reset() override {
    x_ = initial_positions(*scene_);
    v_ = initial_velocities(*scene_);
  }

  StepStatus step(const FrameInput& frame) override {
    // Semi-implicit Euler, once per frame: v += g h, x += v h.
    const double h = frame.dt_s;
    for (std::size_t k = 0; k < x_.size(); ++k) {
      v_[k] += scene_->gravity_m_per_s2[k % 3] * h;
      x_[k] += v_[k] * h;
    }
    return StepStatus::Ok;
  }

  void read_state(ClothState& out) const override {
    out.position = x_;
    out.velocity = v_;
  }

  bool restart(const ClothState& state) override {
    x_ = state.position;
    v_ = state.velocity;
    return true;
  }

  FrameCost last_cost() const override { return {kMissing, {kMissing}, {kMissing}, {kMissing}}; }

  Plan plan() const override {
    Plan p;
    p.stages = {{"fall", {}, 0, kMissing, kMissing}};
    p.left_out = {{"all other features of the scene", "particles only fall"}};
    return p;
  }

 private:
  const SolverInfo info_ = describe();
  const Scene* scene_ = nullptr;
  std::vector<double> x_, v_;
};

}  // namespace

void register_ballistic(std::vector<SolverEntry>& out) {
  out.push_back({describe(), [](const nlohmann::json&, const DeviceOptions&) { return std::make_unique<Ballistic>(); },
                 // Semi-implicit Euler: n v0 h + sum_{k=1..n} k g h^2.
                 [](const Scene& s, const nlohmann::json&, int n) {
                   const double h = s.time.dt();
                   return s.cloth.initial_velocity_m_per_s[1] * h * n + s.gravity_m_per_s2[1] * h * h * n * (n + 1) / 2;
                 }});
}

}  // namespace clothbench
