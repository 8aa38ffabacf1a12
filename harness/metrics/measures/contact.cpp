// Intersection of the cloth with the colliders of its scene: contour, depth, and passages between two frames.
#include <algorithm>

#include "metrics/collider_contact.hpp"
#include "metrics/registry.hpp"

namespace clothbench {
namespace {

bool has_depth(const Scene& s) {
  return kWithContactMetrics && std::any_of(s.colliders.begin(), s.colliders.end(), has_inside);
}

/// Passages through colliders, which the continuous check counts (metrics/motion_check).
double crossings(const RunView& r) {
  const motion_check::Finding* f = r.finding("crossing");
  return f == nullptr ? kMissing : motion_check::kCrossingTolerance * f->ratio;
}

}  // namespace

// Tolerances. Contact amplifies rounding errors until folds move, so results differ by whole edges and by percents.
// Contour lengths may differ by a third of an edge of a 32 x 32 cloth, and depths by half of the millimetre that scenes
// allow in `expect`. The criteria in `expect` themselves have no such tolerance.
MetricGroup contact_metrics() {
  using enum SlackUnit;
  using enum Expect;
  static constexpr Gate kAtRest{1e-2, Length, 0.1, true, "a third of an edge of a 32 × 32 cloth"},
      kImpact{0.1, Length, 0.5, false, "three edges, at a moment of impact"},
      kDepth{5e-4, Length, 0.1, false, "half a millimetre on a cloth of 1 m"}, kPoints{0, One, 0, true, "none"};
  constexpr Needs kInside{"colliders with an inside", has_depth};
  return {{{"contact_length_m", "m", "length of the intersection contour of cloth and colliders", kColliders,
            [](const MetricFrame& f) { return f.contact->length_m; }, 1},
           {"depth_m", "m", "maximum depth of the cloth in a collider, also between vertices", kInside,
            [](const MetricFrame& f) { return f.contact->depth_m; }, 2}},
          {{"contact_length_max_m", greatest("contact_length_m"), Yes, &kImpact},
           {"contact_length_settled_m", greatest_settled("contact_length_m"), Yes, &kAtRest},
           {"depth_max_m", greatest("depth_m"), Yes, &kDepth},
           {"crossings_max",
            own({},
                "number of points that pass through the cloth or a static surface between two frames; maximum over the "
                "frames",
                crossings, "1"),
            Yes, &kPoints}}};
}

}  // namespace clothbench
