#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "plugin/scene_view.hpp"

namespace clothbench::plugin {
namespace {

/// The interface's codes have the order of StepStatus; an unknown code counts as Diverged.
StepStatus status_of(std::int32_t code) {
  static_assert(static_cast<int>(StepStatus::NotFinite) == CLOTHBENCH_NOT_FINITE &&
                static_cast<int>(StepStatus::Diverged) == CLOTHBENCH_DIVERGED &&
                static_cast<int>(StepStatus::DeviceLost) == CLOTHBENCH_DEVICE_LOST &&
                static_cast<int>(StepStatus::TimedOut) == CLOTHBENCH_TIMED_OUT);
  return code >= CLOTHBENCH_OK && code <= CLOTHBENCH_TIMED_OUT ? static_cast<StepStatus>(code) : StepStatus::Diverged;
}

class PluginSolver final : public ClothSolver {
 public:
  PluginSolver(const ClothbenchPlugin& c, SolverInfo info, const nlohmann::json& settings)
      : c_(c), info_(std::move(info)), settings_(setting_values(c, settings)) {}
  ~PluginSolver() override { drop(); }
  PluginSolver(const PluginSolver&) = delete;
  PluginSolver& operator=(const PluginSolver&) = delete;

  const SolverInfo& info() const override { return info_; }

  DeviceInfo device() const override { return device_; }

  void load(const Scene& scene) override {
    drop();
    view_.emplace(scene);
    if (c_.unsupported != nullptr)
      if (const char* why = c_.unsupported(settings_.data(), view_->scene())) {
        if (*why == '\0') fault("unsupported", "expected a reason or NULL; found an empty text");
        throw UnsupportedScene(why);
      }
    const char* why = nullptr;
    self_ = c_.create(settings_.data(), view_->scene(), &why);
    if (self_ == nullptr) fault("create", why != nullptr ? why : "the plugin made no solver and gave no reason");
    device_ = described_device();
    plan_ = described_plan();
    count_names_.clear();
    for (const SolverCount& c : described_counts()) count_names_.push_back(c.name);
  }

  void reset() override {
    const std::size_t n = 3 * std::size_t{view_->scene()->vertex_count};
    const double *x = view_->scene()->position_m, *v = view_->scene()->velocity_m_per_s;
    if (!restart_at({{x, x + n}, {v, v + n}}, {-1, 0, 0, nullptr}))
      fault("restart", "the plugin refuses the scene's start");
  }
  StepStatus step(const FrameInput& in) override { return status_of(c_.step(self_, view_->frame(in))); }

  void read_state(ClothState& out) const override {
    out.position.resize(3 * std::size_t{view_->scene()->vertex_count});
    out.velocity.resize(out.position.size());
    c_.read_state(self_, out.position.data(), out.velocity.data());
  }

  bool restart_at(const ClothState& s, const FrameInput& last) override {
    return c_.restart(self_, view_->restart(s, last)) != 0;
  }

  FrameCost last_cost() const override {
    FrameCost cost;
    cost.device_s = c_.device_s != nullptr ? c_.device_s(self_) : kMissing;
    if (cost.device_s < 0 || std::isinf(cost.device_s))
      fault("device_s", fmt::format("expected a time of 0 s or more, or NAN; found {}", cost.device_s));
    cost.stage_device_s.assign(plan_.stages.size(), kMissing);
    for (const StagePlan& s : plan_.stages) {
      cost.stage_read_B.push_back(s.read_B);
      cost.stage_write_B.push_back(s.write_B);
    }
    return cost;
  }

  Plan plan() const override { return plan_; }

  std::vector<SolverCount> counts() const override {
    std::vector<SolverCount> out = described_counts();
    if (!std::equal(out.begin(), out.end(), count_names_.begin(), count_names_.end(),
                    [](const SolverCount& c, const std::string& name) { return c.name == name; }))
      fault("counts", "expected the same names after every frame");
    return out;
  }

 private:
  void drop() {
    if (self_ != nullptr) c_.destroy(self_);
    self_ = nullptr;
  }

  [[noreturn]] void fault(const char* function, const std::string& what) const {
    throw SolverError(fmt::format("{}: {}: {}", info_.folder, function, what));
  }

  DeviceInfo described_device() const {
    if (c_.device_info == nullptr) return {"CPU", "", "plugin", false, "{}"};
    ClothbenchDevice d{};
    c_.device_info(self_, &d);
    for (const auto& [what, text] : {std::pair{"name", d.name}, {"driver", d.driver}, {"api", d.api}})
      if (text == nullptr || *text == '\0') fault("device_info", fmt::format("{}: expected a text", what));
    const std::string properties = d.properties_json != nullptr ? d.properties_json : "{}";
    if (!json_or_discarded(properties).is_object())
      fault("device_info", "properties_json: expected a JSON object; found " + properties.substr(0, 40));
    return {d.name, d.driver, d.api, d.is_software != 0, properties};
  }

  Plan described_plan() const {
    std::uint32_t count = 0;
    const ClothbenchStage* stages = c_.stages(self_, &count);
    Plan out;
    for (std::uint32_t k = 0; stages != nullptr && k < count; ++k) {
      const ClothbenchStage& s = stages[k];
      out.stages.push_back(
          {s.name != nullptr ? s.name : "unnamed", FeatureSet(s.serves), s.dispatches, s.read_B, s.write_B});
    }
    for (std::uint32_t k = 0; c_.contact_margin_m != nullptr && k < view_->scene()->collider_count; ++k)
      out.contact_margins_m.push_back(c_.contact_margin_m(self_, k));
    return out;
  }

  std::vector<SolverCount> described_counts() const {
    std::uint32_t count = 0;
    const ClothbenchCount* all = c_.counts != nullptr ? c_.counts(self_, &count) : nullptr;
    std::vector<SolverCount> out;
    for (std::uint32_t k = 0; all != nullptr && k < count; ++k) {
      const std::string name = all[k].name != nullptr ? all[k].name : "", doc = all[k].doc != nullptr ? all[k].doc : "";
      if (name.empty() || name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") != std::string::npos)
        fault("counts", "expected a name of small letters, digits, _; found \"" + name + "\"");
      if (doc.empty() || !std::isfinite(all[k].value)) fault("counts", name + ": expected a text and a finite value");
      out.push_back({"solver_" + name, doc, all[k].value});
    }
    return out;
  }

  const ClothbenchPlugin& c_;
  const SolverInfo info_;
  const std::vector<double> settings_;
  std::optional<SceneView> view_;
  void* self_ = nullptr;  ///< this and the next members are valid after a scene is loaded
  DeviceInfo device_ = {"CPU", "", "plugin", false, "{}"};
  Plan plan_;
  std::vector<std::string> count_names_;
};

}  // namespace

std::vector<double> setting_values(const ClothbenchPlugin& c, const nlohmann::json& settings) {
  std::vector<double> out;
  for (std::uint32_t k = 0; k < c.setting_count; ++k) {
    const nlohmann::json v = settings.value(c.settings[k].name, nlohmann::json());
    out.push_back(v.is_number() ? v.get<double>() : c.settings[k].default_value);
  }
  out.push_back(0);  // so that data() is not null if there are no settings
  return out;
}

std::unique_ptr<ClothSolver> make_solver(const ClothbenchPlugin& c, const SolverInfo& info,
                                         const nlohmann::json& settings) {
  return std::make_unique<PluginSolver>(c, info, settings);
}

}  // namespace clothbench::plugin
