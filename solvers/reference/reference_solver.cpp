// The reference solver: double precision, implicit, sparse direct solves; springs without compliance are constraints.
#include <cmath>

#include "base/json_text.hpp"
#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "integrator.hpp"

namespace clothbench {
namespace {

using namespace reference;

SolverInfo describe() {
  SolverInfo info;
  info.name = "reference";
  info.folder = "solvers/reference";
  info.summary = "double precision, implicit, sparse direct: computes reference solutions; slow";
  info.version = "1";
  info.precision = "float64";
  info.time_order = 2;
  info.supports = {Feature::Stretch,    Feature::Shear,      Feature::Bend,    Feature::Damping, Feature::Pins,
                   Feature::MovingPins, Feature::UnevenGrid, Feature::Regions, Feature::Spin,    Feature::ClothMesh};
  info.settings = {
      {"substeps", "16", "steps per frame"},
      {"integrator", "\"bdf2\"", "bdf2 | conservative: implicit midpoint, or RATTLE if the cloth is inextensible"},
      {"tolerance", "1e-8", "Newton's method stops at this residual acceleration, in units of gravity"}};
  return info;
}

class Reference final : public ClothSolver {
 public:
  explicit Reference(const nlohmann::json& settings)
      : substeps_(settings["substeps"].get<int>()),
        conservative_(settings["integrator"] == "conservative"),
        tolerance_(settings["tolerance"].get<double>()) {}

  const SolverInfo& info() const override { return info_; }
  DeviceInfo device() const override { return {"CPU", "", "C++20", false, "{}"}; }

  void load(const Scene& scene) override {
    scene_ = &scene;
    reset();
  }

  void reset() override {
    const Scene& s = *scene_;
    model_ = std::make_unique<Model>(s);
    const double L = std::max(s.cloth.width_m, s.cloth.height_m);
    double acceleration = length(s.gravity_m_per_s2);
    if (acceleration == 0) acceleration = L / (s.time.duration_s * s.time.duration_s);
    const Tolerance t{tolerance_ * acceleration, 1e-12 * L};
    integrator_ = make_integrator(conservative_, *model_, t);
    const auto n = static_cast<Eigen::Index>(3 * model_->vertices());
    const std::vector<double> start = initial_positions(s);
    state_.x = Vector::Map(start.data(), n);
    state_.v.resize(n);
    const std::vector<double> start_velocity = initial_velocities(s);
    for (Eigen::Index k = 0; k < n; ++k) {
      const bool held = model_->held(static_cast<std::size_t>(k / 3));
      state_.v[k] = held ? 0 : start_velocity[static_cast<std::size_t>(k)];
    }
    state_.lambda = Vector::Zero(static_cast<Eigen::Index>(model_->springs()));
    grips_from_.clear();
    for (std::uint32_t v : s.grips.vertices) grips_from_.push_back(vertex_at(start, v));
    grip_held_.assign(s.grips.vertices.size(), 1);
  }

  /// A frame in which Newton's method finds no solution is repeated with twice as many steps.
  StepStatus step(const FrameInput& frame) override {
    std::vector<Vec3> to = grips_from_;
    if (frame.motion != nullptr && !to.empty()) to = frame.motion->grip_position_m;
    const State start = state_;
    StepStatus status = StepStatus::Diverged;
    for (int factor = 1; status == StepStatus::Diverged && factor <= kMaxFactor; factor *= 2) {
      state_ = start;
      status = steps(frame.dt_s, factor * substeps_, to);
    }
    if (status != StepStatus::Ok) return status;
    grips_from_ = to;
    if (frame.motion != nullptr) let_go(frame.motion->grip_held);
    return StepStatus::Ok;
  }

  void read_state(ClothState& out) const override {
    out.position.assign(state_.x.begin(), state_.x.end());
    out.velocity.assign(state_.v.begin(), state_.v.end());
  }

  /// BDF2 restarts with a step of backward Euler.
  bool restart(const ClothState& state) override {
    if (!scene_->motion.empty()) return false;
    reset();
    std::copy(state.position.begin(), state.position.end(), state_.x.begin());
    std::copy(state.velocity.begin(), state.velocity.end(), state_.v.begin());
    return true;
  }

  FrameCost last_cost() const override { return {kMissing, {kMissing}, {kMissing}, {kMissing}}; }

  Plan plan() const override {
    Plan p;
    p.stages = {{"step", scene_->needs & info_.supports, 0, kMissing, kMissing}};
    if (!scene_->needs.has(Feature::Bend)) p.left_out.push_back({"bending", "the scene has none"});
    if (!scene_->needs.has(Feature::Shear)) p.left_out.push_back({"diagonals", "the scene has no shear stiffness"});
    return p;
  }

 private:
  static constexpr int kMaxFactor = 16;

  /// `count` equal steps of a frame; attachments move on straight lines to `to`.
  StepStatus steps(double dt_s, int count, const std::vector<Vec3>& to) {
    for (int k = 0; k < count; ++k) {
      Vector held_x = state_.x;
      const double t = static_cast<double>(k + 1) / count;
      for (std::size_t i = 0; i < to.size(); ++i)
        if (grip_held_[i] != 0)
          for (std::size_t c = 0; c < 3; ++c)
            held_x[static_cast<Eigen::Index>(3 * scene_->grips.vertices[i] + c)] =
                (1 - t) * grips_from_[i][c] + t * to[i][c];
      if (const StepStatus s = integrator_->step(state_, held_x, dt_s / count); s != StepStatus::Ok) return s;
    }
    return StepStatus::Ok;
  }

  void let_go(const std::vector<std::uint8_t>& held) {
    if (held == grip_held_ || held.empty()) return;
    std::vector<std::uint8_t> all(model_->vertices(), 0);
    for (std::uint32_t v : scene_->pins.vertices) all[v] = 1;
    for (std::size_t i = 0; i < held.size(); ++i) all[scene_->grips.vertices[i]] = held[i];
    grip_held_ = held;
    model_->hold(all);
    integrator_->restart();
  }

  const SolverInfo info_ = describe();
  const int substeps_;
  const bool conservative_;
  const double tolerance_;
  const Scene* scene_ = nullptr;
  std::unique_ptr<Model> model_;
  std::unique_ptr<Integrator> integrator_;
  State state_;
  std::vector<Vec3> grips_from_;
  std::vector<std::uint8_t> grip_held_;
};

/// Free fall [m] of one particle by the solver's integrator. Without damping, RATTLE and the midpoint rule agree.
double free_fall_m(const Scene& s, const nlohmann::json& settings, int frames) {
  const int substeps = settings["substeps"].get<int>();
  const double h = s.time.dt() / substeps, g = s.gravity_m_per_s2[1], c = s.material.damping_per_s;
  const bool conservative = settings["integrator"] == "conservative";
  const bool rattle = conservative && !s.material.membrane_stiffness_N_per_m.has_value();
  double x = 0, v = s.cloth.initial_velocity_m_per_s[1], x_before = 0, v_before = 0;
  for (long i = 0; i < static_cast<long>(frames) * substeps; ++i) {
    double x_next = 0, v_next = 0;
    if (rattle) {
      const double keep = std::exp(-c * h / 2), half = keep * v + h / 2 * g;
      x_next = x + h * half;
      v_next = keep * (half + h / 2 * g);
    } else if (conservative) {
      v_next = (v * (1 - c * h / 2) + h * g) / (1 + c * h / 2);
      x_next = x + h / 2 * (v + v_next);
    } else {
      const bool one = i == 0;
      const double k0 = one ? 1 : 1.5, pv = one ? -v : -2 * v + 0.5 * v_before, px = one ? -x : -2 * x + 0.5 * x_before;
      v_next = (h * g - pv) / (k0 + c * h);
      x_next = (h * v_next - px) / k0;
    }
    x_before = x;
    v_before = v;
    x = x_next;
    v = v_next;
  }
  return x;
}

std::unique_ptr<ClothSolver> make(const nlohmann::json& s, const DeviceOptions&) {
  if (!(s["substeps"].get<double>() >= 1 && s["substeps"].get<double>() <= 1e6))
    throw Error("solver reference: setting substeps: expected 1 to 1000000; found " + dump(s["substeps"]));
  if (s["integrator"] != "bdf2" && s["integrator"] != "conservative")
    throw Error("solver reference: setting integrator: expected \"bdf2\" or \"conservative\"; found " +
                dump(s["integrator"]));
  if (!(s["tolerance"].get<double>() > 0 && s["tolerance"].get<double>() <= 1))
    throw Error("solver reference: setting tolerance: expected above 0, at most 1; found " + dump(s["tolerance"]));
  return std::make_unique<Reference>(s);
}

}  // namespace

void register_reference(std::vector<SolverEntry>& out) { out.push_back({describe(), make, free_fall_m}); }

}  // namespace clothbench
