#include "metrics/collider_contact.hpp"

#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "metrics/collider_touch.hpp"
#include "metrics/contact/contact_probe.hpp"
#include "metrics/contact/contour.hpp"

namespace clothbench {

using contact::ContactSample;
using contact::TriangleMeshView;
using contact::TriangleTree;

struct ColliderContact::Probes {
  explicit Probes(const Scene& s)
      : scene(s),
        triangles(clothbench::triangles(s.cloth)),
        links(contact::edges_of(triangles)),
        meshes(s.colliders.size()) {
    for (std::size_t k = 0; k < s.colliders.size(); ++k) {
      const Collider& c = s.colliders[k];
      any_inside |= has_inside(c);
      if (kind_of(c).capsules != nullptr || kind_of(c).half_space) continue;
      try {
        meshes[k] = triangles_of(c, pose_at(s, k, 0));
      } catch (const Error& e) {
        throw Error("collider " + c.name + ": " + e.what());
      }
    }
  }

  ContactSample sample(std::size_t k, int frame, const std::vector<double>& positions) {
    const Collider& c = scene.colliders[k];
    const ColliderKind& kind = kind_of(c);
    const TriangleMeshView cloth{positions, triangles};
    if (kind.half_space)
      return contact::half_space_contact(cloth, contact::point(c.center_m), contact::point(c.normal));
    if (kind.capsules != nullptr)
      return contact::capsule_contact(cloth, contact_capsules(kind.capsules(c, pose_at(scene, k, frame))));
    if (frame > 0 && c.moves()) meshes[k] = triangles_of(c, pose_at(scene, k, frame));
    return contact::mesh_contact(cloth, links, *meshes[k], has_inside(c));
  }

  const Scene& scene;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<contact::Link> links;
  std::vector<std::unique_ptr<TriangleTree>> meshes;  ///< of each collider at the frame probed last; null without one
  bool any_inside = false;
};

ColliderContact::ColliderContact(const Scene& scene) : probes_(std::make_unique<Probes>(scene)) {}
ColliderContact::~ColliderContact() = default;

SceneContact ColliderContact::probe(int frame, const std::vector<double>& positions) {
  Probes& p = *probes_;
  SceneContact all{0, p.any_inside ? 0 : kMissing};
  for (std::size_t k = 0; k < p.meshes.size(); ++k) {
    const ContactSample s = p.sample(k, frame, positions);
    all.length_m += s.contour_length_m;
    if (has_inside(p.scene.colliders[k])) all.depth_m = max_or_nan(all.depth_m, s.depth_max_m);
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
