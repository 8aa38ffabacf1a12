#include "metrics/collider_contact.hpp"

#include <algorithm>
#include <optional>

#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "metrics/collider_surface.hpp"
#include "metrics/contact/contact_probe.hpp"
#include "metrics/contact/contour.hpp"
#include "metrics/contact/half_space.hpp"

namespace clothbench {
namespace {

using contact::ContactProbe;
using contact::ContactSample;
using contact::TriangleMeshView;

contact::Solid solid_of(const Collider& c) {
  if (!has_inside(c)) return contact::Solid::No;
  return !c.mesh || c.mesh->closed ? contact::Solid::Auto : contact::Solid::Nearly;
}

/// One collider and its probe; a half-space needs neither history nor probe.
struct Watched {
  const Collider* collider;
  std::optional<ContactProbe> probe;
};

void add(SceneContact& all, double& moment, const Collider& c, const ContactSample& s) {
  all.length_m += s.contour_length_m;
  all.pairs += s.pairs;
  all.cloth_fraction = max_or_nan(all.cloth_fraction, s.cloth_fraction);
  if (counts_crossings(c)) {
    all.tunnelled_fraction = max_or_nan(all.tunnelled_fraction, s.tunnelled_fraction);
    all.tunnelled_depth_m = max_or_nan(all.tunnelled_depth_m, s.tunnelled_depth_max_m);
  }
  if (!has_inside(c)) return;
  all.depth_m = max_or_nan(all.depth_m, s.depth_max_m);
  all.depth_vertex_m = max_or_nan(all.depth_vertex_m, s.depth_vertex_max_m);
  all.depth_p99_m = max_or_nan(all.depth_p99_m, s.depth_p99_m);
  all.area_m2 += s.area_m2;
  moment += s.area_m2 * s.depth_mean_m;
}

}  // namespace

struct ColliderContact::Probes {
  explicit Probes(const Scene& s) : scene(s), rest(initial_positions(s)), triangles(clothbench::triangles(s.cloth)) {
    for (std::size_t k = 0; k < s.colliders.size(); ++k) {
      any_crossings |= counts_crossings(s.colliders[k]);
      any_inside |= has_inside(s.colliders[k]);
      watch(k);
    }
  }

  const ColliderPose& pose(std::size_t collider, int frame) const {
    static const ColliderPose still;
    const FrameMotion* motion = scene.motion_after(frame - 1);
    return motion ? motion->colliders[collider] : still;
  }

  void watch(std::size_t k) {
    const Collider& c = scene.colliders[k];
    const TriangleMeshView cloth{rest, triangles};
    Watched w{&c, {}};
    try {
      const ColliderKind& kind = kind_of(c);
      if (kind.capsules != nullptr) {
        w.probe.emplace(cloth, contact_capsules(kind.capsules(c, pose(k, 0))));
      } else if (!kind.half_space) {
        const ColliderSurface surface = kind.surface(c, pose(k, 0), {});
        w.probe.emplace(cloth, TriangleMeshView{surface.positions, surface.triangles}, solid_of(c));
      }
    } catch (const Error& e) {
      throw Error("collider " + c.name + ": " + e.what());
    }
    watched.push_back(std::move(w));
  }

  ContactSample sample(std::size_t k, int frame, const std::vector<double>& positions) {
    const Collider& c = *watched[k].collider;
    const ColliderKind& kind = kind_of(c);
    if (kind.half_space)
      return contact::half_space_contact({positions, triangles}, contact::point(c.center_m), contact::point(c.normal));
    ContactProbe& probe = *watched[k].probe;
    if (frame > 0 && c.moves()) {
      if (kind.capsules != nullptr)
        probe.move_shapes(contact_capsules(kind.capsules(c, pose(k, frame))));
      else
        probe.move_object(kind.surface(c, pose(k, frame), {}).positions);
    }
    return probe.probe(positions);
  }

  const Scene& scene;
  std::vector<double> rest;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Watched> watched;
  std::vector<double> contours_m;  ///< of the last probe
  bool any_crossings = false, any_inside = false;
};

ColliderContact::ColliderContact(const Scene& scene) : probes_(std::make_unique<Probes>(scene)) {}
ColliderContact::~ColliderContact() = default;

SceneContact ColliderContact::probe(int frame, const std::vector<double>& positions) {
  Probes& p = *probes_;
  const double tunnelled = p.any_crossings ? 0 : kMissing, depth = p.any_inside ? 0 : kMissing;
  SceneContact all{0, 0, 0, tunnelled, tunnelled, depth, depth, depth, depth, depth};
  double moment = 0;
  p.contours_m.clear();
  for (std::size_t k = 0; k < p.watched.size(); ++k) {
    const ContactSample s = p.sample(k, frame, positions);
    p.contours_m.push_back(s.contour_length_m);
    add(all, moment, *p.watched[k].collider, s);
  }
  // Without penetrating area the mean depth is 0, as the other depths are. NaN stays NaN.
  all.depth_mean_m = all.area_m2 == 0 ? 0 : moment / all.area_m2;
  return all;
}

const std::vector<double>& ColliderContact::contours_m() const { return probes_->contours_m; }

SelfContact self_contact(const std::vector<double>& positions,
                         const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  if (!contact::all_finite(positions)) return {kMissing, kMissing};
  const contact::Contour c = contact::self_contour({positions, triangles});
  return {c.length_m, static_cast<double>(c.pairs)};
}

}  // namespace clothbench
