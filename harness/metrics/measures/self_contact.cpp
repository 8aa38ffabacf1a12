// Self-intersection of the cloth.
#include "metrics/collider_contact.hpp"
#include "metrics/registry.hpp"

namespace clothbench {
namespace {

bool touches_itself(const Scene& s) { return kWithContactMetrics && s.needs.has(Feature::SelfCollision); }

/// Excess over the value at the start, so that a self-intersecting start does not count against a solver.
Reduction beyond_start(Reduction r) {
  return {r.series, r.how + ", minus the value of the initial frame",
          [series = r.series.front(), value = r.value](const RunView& run) {
            const double v = value(run);
            return v != v ? v : max_or_nan(0, v - run.series(series)->front());
          }};
}

}  // namespace

MetricGroup self_contact_metrics() {
  using enum SlackUnit;
  using enum Expect;
  static constexpr Gate kPairs{4, One, 0.1, true, "four pairs of thousands"},
      kLength{1e-2, Length, 0.1, true, "a third of an edge of a 32 × 32 cloth"};
  constexpr Needs kSelf{"cloth.self_collision", touches_itself};
  return {{{"self_contact_length_m", "m", "length of the self-intersection contour", kSelf,
            [](const MetricFrame& f) { return f.self_contact->length_m; }},
           {"self_contact_pairs", "1", "number of intersecting pairs of cloth triangles that share no vertex", kSelf,
            [](const MetricFrame& f) { return f.self_contact->pairs; }}},
          {{"self_contact_pairs_max", beyond_start(greatest("self_contact_pairs")), Yes, &kPairs},
           {"self_contact_length_max_m", beyond_start(greatest("self_contact_length_m")), Yes, &kLength},
           {"self_contact_length_settled_m", beyond_start(greatest_settled("self_contact_length_m")), Yes, &kLength}}};
}

}  // namespace clothbench
