#pragma once
#include <memory>
#include <vector>

#include "metrics/metric.hpp"
#include "scenario/strict_contact.hpp"

namespace clothbench {

#ifdef CLOTHBENCH_HAS_CONTACT_METRICS
inline constexpr bool kWithContactMetrics = true;
#else
inline constexpr bool kWithContactMetrics = false;  // built without CGAL: the contact rows apply to no scene
#endif

inline constexpr Needs kColliders{"colliders",
                                  [](const Scene& s) { return kWithContactMetrics && !s.colliders.empty(); }};

/// The contact of one cloth with all colliders of its scene, frame after frame: one contact::ContactProbe per collider,
/// moved as Scene::motion prescribes. The geometry of the collider kind decides the method
/// (scenario/collider_kinds.hpp): signed distance for capsules, exact clipping for half-spaces, triangles for the rest,
/// which for a box is exact.
///
/// Results are combined over the colliders. Lengths, pairs and areas are sums (where colliders overlap, both count);
/// fractions and depths are maxima; the mean depth is taken over the sum of the penetrating areas.
class ColliderContact {
 public:
  /// `scene` outlives this. Throws Error naming the collider that cannot be probed.
  explicit ColliderContact(const Scene& scene);
  ~ColliderContact();
  ColliderContact(const ColliderContact&) = delete;
  ColliderContact& operator=(const ColliderContact&) = delete;

  /// Positions [m] at the end of frame `frame`, 0 = the initial state; every frame once and in order.
  SceneContact probe(int frame, const std::vector<double>& positions);
  /// Length [m] of the contour with each collider at the last probe.
  const std::vector<double>& contours_m() const;

 private:
  struct Probes;
  std::unique_ptr<Probes> probes_;
};

/// Self-intersection of a cloth with these triangles; exact (contact::self_contour).
SelfContact self_contact(const std::vector<double>& positions,
                         const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace clothbench
