#pragma once
#include <memory>
#include <vector>

#include "metrics/metric.hpp"

namespace clothbench {

#ifdef CLOTHBENCH_HAS_CONTACT_METRICS
inline constexpr bool kWithContactMetrics = true;
#else
inline constexpr bool kWithContactMetrics = false;  // built without CGAL: the contact rows apply to no scene
#endif

inline constexpr Needs kColliders{"colliders",
                                  [](const Scene& s) { return kWithContactMetrics && !s.colliders.empty(); }};

/// Whether depth in it is defined: all shapes but meshes (of a plane the half-space behind it), closed meshes with
/// their normals outwards, and skinned ones, which are hands open at the wrist at most. Rooms have no inside.
bool has_inside(const Collider&);

/// Whether crossing it is counted (tunnelled fraction): meshes, open or closed.
bool counts_crossings(const Collider&);

/// The contact of one cloth with all colliders of its scene, frame after frame: a contact::ContactProbe for each, moved
/// as Scene::motion says. What its kind has of geometry decides how (scenario/collider_kinds.hpp): capsules by their
/// signed distance, half-spaces exactly, the rest as triangles, which for a box is exact.
///
/// Put together over the colliders: lengths, pairs and areas are sums (where colliders overlap, both count); fractions
/// and depths are the greatest; the mean depth is over the sum of penetrating areas.
class ColliderContact {
 public:
  /// `scene` outlives this. Throws Error naming the collider that cannot be probed.
  explicit ColliderContact(const Scene& scene);
  ~ColliderContact();
  ColliderContact(const ColliderContact&) = delete;
  ColliderContact& operator=(const ColliderContact&) = delete;

  /// Positions [m] at the end of frame `frame`, 0 = the initial state; every frame once and in order.
  SceneContact probe(int frame, const std::vector<double>& positions);

 private:
  struct Probes;
  std::unique_ptr<Probes> probes_;
};

/// How a cloth of these triangles crosses itself; exact (contact::self_contour).
SelfContact self_contact(const std::vector<double>& positions,
                         const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace clothbench
