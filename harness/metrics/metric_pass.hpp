#pragma once
#include <memory>
#include <vector>

#include "clothbench/record.hpp"
#include "metrics/metric.hpp"

namespace clothbench {

class ColliderContact;
class ColliderPassage;
class StabilityJudge;
class TruthJudge;

/// The metrics of one accuracy pass over one run: those that apply to its scene, each evaluated once a frame. Keeps
/// what has to be remembered from frame to frame (where the cloth was when a collider passed it), so frames come in
/// order.
class MetricPass {
 public:
  /// What `context` refers to outlives the pass.
  explicit MetricPass(const MetricContext& context);
  ~MetricPass();
  MetricPass(const MetricPass&) = delete;
  MetricPass& operator=(const MetricPass&) = delete;

  /// State at the end of the next frame; the first call is frame 0, the initial state.
  void add(const ClothState&);
  /// Whether a stability class has been met that a run does not come back from: not finite, speed or energy out of
  /// bounds.
  bool lost() const { return lost_; }

  /// One series a metric, in the order of metrics().
  std::vector<MetricSeries> take() { return std::move(series_); }

 private:
  MetricContext context_;
  std::vector<const Metric*> wanted_;
  std::vector<MetricSeries> series_;
  std::unique_ptr<ColliderContact> contact_;             ///< null where there is nothing to touch
  std::unique_ptr<ColliderPassage> passage_;             ///< the same
  std::unique_ptr<TruthJudge> judge_;                    ///< null where the scene states no truth
  std::unique_ptr<StabilityJudge> stability_;            ///< null where the scene is not judged
  std::vector<std::array<std::uint32_t, 3>> triangles_;  ///< empty where the cloth does not touch itself
  bool lost_ = false;
  int frame_ = 0;
};

}  // namespace clothbench
