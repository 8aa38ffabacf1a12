#include "metrics/collider_contact.hpp"

#include <algorithm>
#include <optional>

#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "metrics/collider_touch.hpp"
#include "metrics/contact/contact_probe.hpp"
#include "metrics/contact/contour.hpp"

namespace clothbench {
namespace {

using contact::ContactProbe;
using contact::ContactSample;
using contact::TriangleMeshView;

contact::Solid solid_of(const Collider& c) {
  if (!has_inside(c)) return contact::Solid::No;
  return !c.mesh || c.mesh->closed ? contact::Solid::Auto : contact::Solid::Nearly;
}

/// One collider and its probe; a half-space needs none.
struct Watched {
  const Collider* collider;
  std::optional<ContactProbe> probe;
};

}  // namespace

struct ColliderContact::Probes {
  explicit Probes(const Scene& s) : scene(s), rest(initial_positions(s)), triangles(clothbench::triangles(s.cloth)) {
    for (std::size_t k = 0; k < s.colliders.size(); ++k) {
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
  bool any_inside = false;
};

ColliderContact::ColliderContact(const Scene& scene) : probes_(std::make_unique<Probes>(scene)) {}
ColliderContact::~ColliderContact() = default;

SceneContact ColliderContact::probe(int frame, const std::vector<double>& positions) {
  Probes& p = *probes_;
  SceneContact all{0, p.any_inside ? 0 : kMissing};
  for (std::size_t k = 0; k < p.watched.size(); ++k) {
    const ContactSample s = p.sample(k, frame, positions);
    all.length_m += s.contour_length_m;
    if (has_inside(*p.watched[k].collider)) all.depth_m = max_or_nan(all.depth_m, s.depth_max_m);
  }
  return all;
}

SelfContact self_contact(const std::vector<double>& positions,
                         const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  if (!contact::all_finite(positions)) return {kMissing, kMissing};
  const contact::Contour c = contact::self_contour({positions, triangles});
  return {c.length_m, static_cast<double>(c.pairs)};
}

}  // namespace clothbench
