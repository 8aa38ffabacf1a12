#include "metrics/collider_contact.hpp"

#include <algorithm>
#include <optional>

#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "metrics/contact/contact_probe.hpp"
#include "metrics/contact/contour.hpp"
#include "metrics/contact/half_space.hpp"

namespace clothbench {
namespace {

using contact::ContactProbe;
using contact::ContactSample;
using contact::TriangleMeshView;

std::vector<contact::Capsule> shapes_of(const std::vector<Capsule>& capsules) {
  std::vector<contact::Capsule> out;
  for (const Capsule& c : capsules) out.push_back({contact::point(c.a_m), contact::point(c.b_m), c.radius_m});
  return out;
}

/// The twelve triangles of a box, counter-clockwise seen from outside.
ColliderMesh box_mesh(const Collider& box) {
  ColliderMesh mesh;
  for (unsigned corner = 0; corner < 8; ++corner)
    for (std::size_t k = 0; k < 3; ++k) {
      double x = box.center_m[k];
      for (unsigned a = 0; a < 3; ++a) x += ((corner >> a & 1u) != 0 ? 1 : -1) * box.half_extent_m[a] * box.axes[a][k];
      mesh.positions.push_back(x);
    }
  // Corner bits are x, y, z; each face as two triangles round its diagonal.
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  mesh.closed = true;
  return mesh;
}

contact::Solid solid_of(const Collider& c) {
  if (!has_inside(c)) return contact::Solid::No;
  const bool closed = c.shape != Collider::Shape::Mesh || c.mesh->closed;
  return closed ? contact::Solid::Auto : contact::Solid::Nearly;
}

/// One collider and what watches it; a half-space needs no history and no probe.
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
      if (c.shape == Collider::Shape::Sphere) {
        const contact::Capsule ball = contact::sphere(contact::point(c.center_m), c.radius_m);
        w.probe.emplace(cloth, std::span(&ball, 1));
      } else if (c.shape == Collider::Shape::Capsules) {
        w.probe.emplace(cloth, shapes_of(pose(k, 0).capsules));
      } else if (c.shape == Collider::Shape::Box) {
        const ColliderMesh mesh = box_mesh(c);
        w.probe.emplace(cloth, TriangleMeshView{mesh.positions, mesh.triangles}, solid_of(c));
      } else if (c.shape == Collider::Shape::Mesh) {
        const std::vector<double> start = posed_positions(*c.mesh, pose(k, 0));
        w.probe.emplace(cloth, TriangleMeshView{start, c.mesh->triangles}, solid_of(c));
      }
    } catch (const Error& e) {
      throw Error("collider " + c.name + ": " + e.what());
    }
    watched.push_back(std::move(w));
  }

  ContactSample sample(std::size_t k, int frame, const std::vector<double>& positions) {
    const Collider& c = *watched[k].collider;
    if (c.shape == Collider::Shape::Plane)
      return contact::half_space_contact({positions, triangles}, contact::point(c.center_m), contact::point(c.normal));
    ContactProbe& probe = *watched[k].probe;
    if (frame > 0 && c.shape == Collider::Shape::Capsules) probe.move_shapes(shapes_of(pose(k, frame).capsules));
    if (frame > 0 && c.shape == Collider::Shape::Mesh && c.moves())
      probe.move_object(posed_positions(*c.mesh, pose(k, frame)));
    return probe.probe(positions);
  }

  const Scene& scene;
  std::vector<double> rest;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Watched> watched;
  bool any_crossings = false, any_inside = false;
};

ColliderContact::ColliderContact(const Scene& scene) : probes_(std::make_unique<Probes>(scene)) {}
ColliderContact::~ColliderContact() = default;

SceneContact ColliderContact::probe(int frame, const std::vector<double>& positions) {
  Probes& p = *probes_;
  const double tunnelled = p.any_crossings ? 0 : kMissing, depth = p.any_inside ? 0 : kMissing;
  SceneContact all{0, 0, 0, tunnelled, tunnelled, depth, depth, depth, depth, depth};
  double moment = 0;
  for (std::size_t k = 0; k < p.watched.size(); ++k)
    add(all, moment, *p.watched[k].collider, p.sample(k, frame, positions));
  // Nothing inside: no area to take a mean over, and a mean depth of 0 as the other depths. NaN stays NaN.
  all.depth_mean_m = all.area_m2 == 0 ? 0 : moment / all.area_m2;
  return all;
}

SelfContact self_contact(const std::vector<double>& positions,
                         const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  if (!contact::all_finite(positions)) return {kMissing, kMissing};
  const contact::Contour c = contact::self_contour({positions, triangles});
  return {c.length_m, static_cast<double>(c.pairs)};
}

}  // namespace clothbench
