#include "plugin/plugin_solver.hpp"

#include <optional>

#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "plugin/scene_view.hpp"

namespace clothbench::plugin {
namespace {

StepStatus status_of(std::int32_t code) {
  switch (code) {
    case CLOTHBENCH_OK:
      return StepStatus::Ok;
    case CLOTHBENCH_NOT_FINITE:
      return StepStatus::NotFinite;
    case CLOTHBENCH_DEVICE_LOST:
      return StepStatus::DeviceLost;
    case CLOTHBENCH_TIMED_OUT:
      return StepStatus::TimedOut;
    default:  // CLOTHBENCH_DIVERGED, and what the interface does not know
      return StepStatus::Diverged;
  }
}

class PluginSolver final : public ClothSolver {
 public:
  PluginSolver(const ClothbenchPlugin& c, SolverInfo info, const nlohmann::json& settings)
      : c_(c), info_(std::move(info)), settings_(setting_values(c, settings)) {}
  ~PluginSolver() override { drop(); }
  PluginSolver(const PluginSolver&) = delete;
  PluginSolver& operator=(const PluginSolver&) = delete;

  const SolverInfo& info() const override { return info_; }

  DeviceInfo device() const override {
    const char* name = c_.device != nullptr && self_ != nullptr ? c_.device(self_) : nullptr;
    return {name != nullptr ? name : "CPU", "", "plugin", false, "{}"};
  }

  void load(const Scene& scene) override {
    drop();
    view_.emplace(scene);
    const char* why = nullptr;
    self_ = c_.create(settings_.data(), view_->scene(), &why);
    if (self_ == nullptr)
      throw SolverError(info_.folder +
                        ": create: " + (why != nullptr ? why : "the plugin does not say why it makes no solver"));
  }

  void reset() override {
    if (c_.reset != nullptr) return c_.reset(self_);
    if (c_.restart(self_, view_->scene()->position_m, view_->scene()->velocity_m_per_s) == 0)
      throw SolverError(info_.folder + ": restart: refuses the scene's own start, and there is no reset");
  }
  StepStatus step(const FrameInput& in) override { return status_of(c_.step(self_, view_->frame(in))); }

  void read_state(ClothState& out) const override {
    out.position.resize(3 * std::size_t{view_->scene()->vertex_count});
    out.velocity.resize(out.position.size());
    c_.read_state(self_, out.position.data(), out.velocity.data());
  }

  bool restart(const ClothState& s) override {
    return c_.restart != nullptr && c_.restart(self_, s.position.data(), s.velocity.data()) != 0;
  }

  FrameCost last_cost() const override {
    FrameCost cost;
    cost.device_s = c_.device_s != nullptr ? c_.device_s(self_) : kMissing;
    for (const StagePlan& s : plan().stages) {
      cost.stage_device_s.push_back(kMissing);
      cost.stage_read_B.push_back(s.read_B);
      cost.stage_write_B.push_back(s.write_B);
    }
    return cost;
  }

  Plan plan() const override {
    std::uint32_t count = 0;
    const ClothbenchStage* stages = c_.stages(self_, &count);
    Plan out;
    for (std::uint32_t k = 0; stages != nullptr && k < count; ++k) {
      const ClothbenchStage& s = stages[k];
      out.stages.push_back(
          {s.name != nullptr ? s.name : "unnamed", features_of(s.serves), s.dispatches, s.read_B, s.write_B});
    }
    for (std::uint32_t k = 0; c_.contact_margin_m != nullptr && k < view_->scene()->collider_count; ++k)
      out.contact_margins_m.push_back(c_.contact_margin_m(self_, k));
    return out;
  }

 private:
  void drop() {
    if (self_ != nullptr) c_.destroy(self_);
    self_ = nullptr;
  }

  const ClothbenchPlugin& c_;
  const SolverInfo info_;
  const std::vector<double> settings_;
  std::optional<SceneView> view_;
  void* self_ = nullptr;  ///< there once a scene is loaded
};

}  // namespace

std::vector<double> setting_values(const ClothbenchPlugin& c, const nlohmann::json& settings) {
  std::vector<double> out;
  for (std::uint32_t k = 0; k < c.setting_count; ++k) {
    const nlohmann::json v = settings.value(c.settings[k].name, nlohmann::json());
    out.push_back(v.is_number() ? v.get<double>() : c.settings[k].default_value);
  }
  out.push_back(0);  // a pointer to nothing would be none
  return out;
}

FeatureSet features_of(std::uint32_t bits) {
  FeatureSet out;
  for (std::size_t k = 0; k < kFeatureCount; ++k)
    if ((bits >> k & 1u) != 0) out.add(static_cast<Feature>(k));
  return out;
}

std::unique_ptr<ClothSolver> make_solver(const ClothbenchPlugin& c, const SolverInfo& info,
                                         const nlohmann::json& settings) {
  return std::make_unique<PluginSolver>(c, info, settings);
}

}  // namespace clothbench::plugin
