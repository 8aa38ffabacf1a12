#include "metrics/metric_pass.hpp"

#include "metrics/collider_contact.hpp"
#include "metrics/registry.hpp"
#include "metrics/stability/judge.hpp"
#include "metrics/truth_errors.hpp"

namespace clothbench {

MetricPass::MetricPass(const MetricContext& context) : context_(context) {
  for (const Metric& m : metrics()) {
    if (!m.applies(context.scene)) continue;
    wanted_.push_back(&m);
    series_.push_back({m.name, m.units, m.long_name, {}});
  }
  if (kWithContactMetrics && !context.scene.colliders.empty())
    contact_ = std::make_unique<ColliderContact>(context.scene, context.contact_margins_m);
  if (kWithContactMetrics && context.scene.needs.has(Feature::SelfCollision))
    triangles_ = triangles(context.scene.cloth);
  if (!context.scene.reference_case.empty()) judge_ = std::make_unique<TruthJudge>(context.scene);
  if (!context.scene.stability.name.empty()) stability_ = std::make_unique<StabilityJudge>(context.scene);
}

MetricPass::~MetricPass() = default;

void MetricPass::add(const ClothState& state) {
  SceneContact contact{};
  SceneTouch touch{};
  if (contact_) {
    contact = contact_->probe(frame_, state.position);
    touch = contact_->touch(frame_, state.position);
  }
  SelfContact self{};
  if (!triangles_.empty()) self = self_contact(state.position, triangles_);
  TruthErrors truth;
  if (judge_) truth = judge_->judge(frame_, state);
  StabilityFrame stability;
  if (stability_) stability = stability_->judge(frame_, state, judge_ ? &truth : nullptr);
  lost_ = lost_ || stability.lost();
  const MetricFrame frame{context_,
                          frame_,
                          state,
                          contact_ ? &contact : nullptr,
                          contact_ ? &touch : nullptr,
                          judge_ ? &truth : nullptr,
                          stability_ ? &stability : nullptr,
                          triangles_.empty() ? nullptr : &self};
  for (std::size_t m = 0; m < wanted_.size(); ++m) series_[m].values.push_back(wanted_[m]->value(frame));
  ++frame_;
}

}  // namespace clothbench
