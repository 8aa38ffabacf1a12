#pragma once
#include <memory>
#include <vector>

#include "clothbench/record.hpp"
#include "metrics/metric.hpp"

namespace clothbench {

class ColliderContact;
class StabilityJudge;
class TruthJudge;

/// The metrics of one accuracy pass over one run: those that apply to its scene, each evaluated once per frame. Keeps
/// state between frames (such as the vertices that touched), so frames must be added in order.
class MetricPass {
 public:
  /// The objects that `context` refers to must outlive the pass.
  explicit MetricPass(const MetricContext& context);
  ~MetricPass();
  MetricPass(const MetricPass&) = delete;
  MetricPass& operator=(const MetricPass&) = delete;

  /// State at the end of the next frame; the first call is frame 0, the initial state.
  void add(const ClothState&);
  /// Whether the run has reached a stability class from which it cannot recover: not finite, or speed or energy out of
  /// bounds.
  bool lost() const { return lost_; }

  /// One series per metric, in the order of metrics().
  std::vector<MetricSeries> take() { return std::move(series_); }

 private:
  MetricContext context_;
  std::vector<const Metric*> wanted_;
  std::vector<MetricSeries> series_;
  std::unique_ptr<ColliderContact> contact_;             ///< null if the scene has no collider
  std::unique_ptr<TruthJudge> judge_;                    ///< null where the scene states no truth
  std::unique_ptr<StabilityJudge> stability_;            ///< null where the scene is not judged
  std::vector<std::array<std::uint32_t, 3>> triangles_;  ///< empty where the cloth does not touch itself
  bool lost_ = false;
  int frame_ = 0;
};

}  // namespace clothbench
