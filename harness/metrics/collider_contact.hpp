#pragma once
#include <memory>
#include <vector>

#include "metrics/metric.hpp"
#include "scenario/load.hpp"

namespace clothbench {

#ifdef CLOTHBENCH_HAS_CONTACT_METRICS
inline constexpr bool kWithContactMetrics = true;
#else
inline constexpr bool kWithContactMetrics = false;  // built without CGAL: metrics of colliders apply to no scene
#endif

inline constexpr Needs kColliders{"colliders",
                                  [](const Scene& s) { return kWithContactMetrics && !s.colliders.empty(); }};

/// The contact of one cloth with all colliders of its scene, frame by frame. Scene::motion gives the colliders' poses.
/// The kind of a collider decides its geometry (scenario/collider_kinds.hpp): capsules, a half-space or triangles.
/// Contour lengths are summed over the colliders (if two overlap, both count); the depth is the maximum over the
/// colliders.
///
/// A point of the cloth touches a collider if its distance is at most the solver's contact offset plus a tolerance: a
/// tenth of the offset or a thousandth of the cloth's shorter side, whichever is larger. A triangle touches if any of
/// its points does, including points of its edges and face. Slip is computed from vertices only.
class ColliderContact {
 public:
  virtual ~ColliderContact() = default;
  /// Positions [m] at the end of frame `frame`, 0 = the initial state.
  virtual SceneContact probe(int frame, const std::vector<double>& positions) = 0;
  /// Touch and slip in a frame. Call in the order of frames, because slip compares a frame with the previous one.
  virtual SceneTouch touch(int frame, const std::vector<double>& positions) = 0;
};

/// `scene` must outlive the result. `held_at_m`: the solver's contact offset per collider, as in
/// Plan::contact_margins_m; if not stated, the collider's margin_m. Throws Error naming an invalid collider.
std::unique_ptr<ColliderContact> collider_contact(const Scene& scene, const std::vector<double>& held_at_m = {});

/// Self-intersection of a cloth with these triangles; exact (contact::self_contour).
SelfContact self_contact(const std::vector<double>& positions,
                         const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace clothbench
