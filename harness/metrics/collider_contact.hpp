#pragma once
#include <memory>
#include <vector>

#include "metrics/metric.hpp"
#include "scenario/load.hpp"

namespace clothbench {

#ifdef CLOTHBENCH_HAS_CONTACT_METRICS
inline constexpr bool kWithContactMetrics = true;
#else
inline constexpr bool kWithContactMetrics = false;  // built without CGAL: the contact rows apply to no scene
#endif

inline constexpr Needs kColliders{"colliders",
                                  [](const Scene& s) { return kWithContactMetrics && !s.colliders.empty(); }};

/// The contact of one cloth with all colliders of its scene, frame after frame: each collider
/// placed as Scene::motion prescribes. The geometry of the collider kind decides the method
/// (scenario/collider_kinds.hpp): capsules, half-spaces, triangles. Lengths are summed over the colliders (where they
/// overlap, both count); the depth is the maximum over colliders.
///
/// A point of the cloth touches a collider up to the distance at which the solver holds cloth plus the greater of a
/// tenth of it and a thousandth of the cloth's shorter side. A triangle touches if any of its points does, edges and
/// face included. Only vertices slide.
class ColliderContact {
 public:
  virtual ~ColliderContact() = default;
  /// Positions [m] at the end of frame `frame`, 0 = the initial state.
  virtual SceneContact probe(int frame, const std::vector<double>& positions) = 0;
  /// The same; in the order of frames, because it compares with the one before. NaN touches nothing.
  virtual SceneTouch touch(int frame, const std::vector<double>& positions) = 0;
};

/// `scene` outlives the result. `held_at_m`: how far off each collider the solver keeps cloth, as in
/// Plan::contact_margins_m; its margin where it does not say. Throws Error naming the collider that cannot be probed.
std::unique_ptr<ColliderContact> collider_contact(const Scene& scene, const std::vector<double>& held_at_m = {});

/// Self-intersection of a cloth with these triangles; exact (contact::self_contour).
SelfContact self_contact(const std::vector<double>& positions,
                         const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace clothbench
