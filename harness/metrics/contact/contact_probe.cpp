#include "metrics/contact/contact_probe.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "clothbench/record.hpp"
#include "metrics/contact/contour.hpp"
#include "metrics/contact/surface.hpp"
#include "metrics/contact/tunnel.hpp"

namespace clothbench::contact {
namespace {

/// Depth [m] of a triangle in a capsule; 0 or less if it is outside.
double depth_in(const Simplex<3>& triangle, const Capsule& c) {
  // Most capsules are far away, which the boxes show at less cost; the factor covers rounding.
  const double apart = box_of(triangle).squaredExteriorDistance(Box(c.a).extend(c.b));
  if (apart > c.radius_m * c.radius_m * (1 + 1e-12)) return 0;
  return c.radius_m - std::sqrt(squared_distance(c.a, c.b, triangle));
}

/// Whether a point of the surface of capsule `own` lies inside another. Capsules that share a joint share its surface,
/// which counts for the first of them.
bool hidden(const Point<3>& p, std::span<const Capsule> shapes, std::size_t own) {
  for (std::size_t k = 0; k < shapes.size(); ++k)
    if (k != own && signed_distance(p, shapes[k]) < (k < own ? 0 : -kCapsuleError * shapes[k].radius_m)) return true;
  return false;
}

double depth_in_mesh(const TriangleMeshView& cloth, std::span<const Link> links, const TriangleTree& mesh) {
  const Box& box = mesh.tree().box();
  double most = 0;
  const auto at = [&](const Point<3>& p) {
    if (box.contains(p) && is_inside(p, mesh)) most = std::max(most, mesh.distance(p));
  };
  for (std::size_t v = 0; v < cloth.vertex_count(); ++v) at(cloth.vertex(v));
  for (const auto& [a, b] : links) at(0.5 * (cloth.vertex(a) + cloth.vertex(b)));
  for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
    const Simplex<3> v = cloth.triangle(t);
    at((v[0] + v[1] + v[2]) / 3);
  }
  return most;
}

}  // namespace

ContactSample mesh_contact(const TriangleMeshView& cloth, std::span<const Link> links, const TriangleTree& mesh,
                           bool has_inside) {
  if (!all_finite(cloth.positions)) return {kMissing, kMissing};
  return {contour(cloth, mesh).length_m, has_inside ? depth_in_mesh(cloth, links, mesh) : kMissing};
}

ContactSample capsule_contact(const TriangleMeshView& cloth, std::span<const Capsule> shapes) {
  if (!all_finite(cloth.positions)) return {kMissing, kMissing};
  ContactSample out{0, 0};
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    std::vector<Simplex<3>> within;
    for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
      const Simplex<3> triangle = cloth.triangle(t);
      const double depth = depth_in(triangle, shapes[k]);
      if (!(depth > 0)) continue;
      out.depth_max_m = std::max(out.depth_max_m, depth);
      if (!is_degenerate(triangle)) within.push_back(triangle);
    }
    if (within.empty()) continue;
    const TriangleTree surface(capsule_mesh(shapes[k]).view());
    for (const Simplex<3>& triangle : within)
      surface.tree().for_each_overlapping(box_of(triangle), [&](int facet) {
        const auto cut = intersection(triangle, surface.triangles()[static_cast<std::size_t>(facet)]);
        if (cut && !hidden(0.5 * ((*cut)[0] + (*cut)[1]), shapes, k))
          out.contour_length_m += ((*cut)[1] - (*cut)[0]).norm();
      });
  }
  return out;
}

ContactSample half_space_contact(const TriangleMeshView& cloth, const Point<3>& on_plane, const Point<3>& normal) {
  if (!all_finite(cloth.positions)) return {kMissing, kMissing};
  ContactSample out{0, 0};
  const auto depth_of = [&](const Point<3>& p) { return normal.dot(on_plane - p); };
  for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
    const Simplex<3> v = cloth.triangle(t);
    const std::array<double, 3> f{depth_of(v[0]), depth_of(v[1]), depth_of(v[2])};
    for (const double d : f) out.depth_max_m = std::max(out.depth_max_m, d);
    const auto behind = std::count_if(f.begin(), f.end(), [](double d) { return d > 0; });
    if (behind == 0 || behind == 3) continue;
    // `lone` is the only corner on its side.
    std::size_t lone = 0;
    while ((f[lone] > 0) != (behind == 1)) ++lone;
    const auto cut = [&](std::size_t k) { return Point<3>(v[lone] + f[lone] / (f[lone] - f[k]) * (v[k] - v[lone])); };
    out.contour_length_m += (cut((lone + 2) % 3) - cut((lone + 1) % 3)).norm();
  }
  return out;
}

}  // namespace clothbench::contact
