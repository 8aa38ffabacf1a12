#include "metrics/contact/contact_probe.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "metrics/contact/contour.hpp"
#include "metrics/contact/touch.hpp"
#include "metrics/contact/winding.hpp"

namespace clothbench::contact {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Triangles copy(std::span<const std::array<std::uint32_t, 3>> t) { return {t.begin(), t.end()}; }

Box box_of(const Simplex<3>& t) { return Box(t[0]).extend(t[1]).extend(t[2]); }

void validate(std::span<const Capsule> shapes) {
  for (std::size_t k = 0; k < shapes.size(); ++k)
    if (!shapes[k].a.allFinite() || !shapes[k].b.allFinite() || !(shapes[k].radius_m > 0) ||
        !std::isfinite(shapes[k].radius_m))
      throw Error("contact capsule " + std::to_string(k) + ": expected finite ends and a positive radius");
}

/// An object made of triangles.
struct MeshObject {
  MeshObject(const TriangleMeshView& mesh, Solid solid)
      : triangles(copy(mesh.triangles)),
        vertices(mesh.vertex_count()),
        tree(mesh),
        closed(is_closed(mesh, welded_vertices(mesh))),
        has_inside(solid == Solid::Nearly || (solid == Solid::Auto && closed)) {}

  Triangles triangles;
  std::size_t vertices;
  TriangleTree tree;
  bool closed, has_inside;
};

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

}  // namespace

struct ContactProbe::State {
  explicit State(const TriangleMeshView& cloth)
      : triangles(copy(cloth.triangles)), vertices(cloth.vertex_count()), links(edges_of(cloth.triangles)) {
    validate(cloth, "contact cloth");
    const auto has_area = [&](std::size_t t) { return area(cloth.triangle(t)) > 0; };
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (has_area(t)) return;
    throw Error("contact cloth: expected at least one triangle with area");
  }

  double depth_in_mesh(const TriangleMeshView& cloth) const;
  ContactSample in_shapes(const TriangleMeshView& cloth) const;

  Triangles triangles;
  std::size_t vertices;
  std::vector<Link> links;
  std::optional<MeshObject> mesh;
  std::vector<Capsule> shapes;
};

double ContactProbe::State::depth_in_mesh(const TriangleMeshView& cloth) const {
  const InsideTest inside(mesh->tree, mesh->closed);
  const Box& box = mesh->tree.tree().box();
  double most = 0;
  const auto at = [&](const Point<3>& p) {
    if (box.contains(p) && inside(p)) most = std::max(most, mesh->tree.distance(p));
  };
  for (std::size_t v = 0; v < cloth.vertex_count(); ++v) at(cloth.vertex(v));
  for (const auto& [a, b] : links) at(0.5 * (cloth.vertex(a) + cloth.vertex(b)));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Simplex<3> v = cloth.triangle(t);
    at((v[0] + v[1] + v[2]) / 3);
  }
  return most;
}

ContactSample ContactProbe::State::in_shapes(const TriangleMeshView& cloth) const {
  ContactSample out{0, 0};
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    std::vector<Simplex<3>> within;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
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

ContactProbe::ContactProbe(const TriangleMeshView& cloth_at_rest, const TriangleMeshView& object, Solid solid)
    : state_(std::make_unique<State>(cloth_at_rest)) {
  state_->mesh.emplace(object, solid);
}

ContactProbe::ContactProbe(const TriangleMeshView& cloth_at_rest, std::span<const Capsule> shapes)
    : state_(std::make_unique<State>(cloth_at_rest)) {
  validate(shapes);
  state_->shapes.assign(shapes.begin(), shapes.end());
}

ContactProbe::~ContactProbe() = default;
ContactProbe::ContactProbe(ContactProbe&&) noexcept = default;
ContactProbe& ContactProbe::operator=(ContactProbe&&) noexcept = default;

void ContactProbe::move_object(std::span<const double> positions) {
  if (!state_->mesh) throw Error("move_object: expected a probe of a mesh, this one has capsules");
  MeshObject& mesh = *state_->mesh;
  if (positions.size() != 3 * mesh.vertices)
    throw Error("move_object: expected " + std::to_string(mesh.vertices) + " vertices, got " +
                std::to_string(positions.size() / 3));
  mesh.tree = TriangleTree({positions, mesh.triangles});
}

void ContactProbe::move_shapes(std::span<const Capsule> shapes) {
  if (state_->mesh) throw Error("move_shapes: expected a probe of capsules, this one has a mesh");
  if (shapes.size() != state_->shapes.size())
    throw Error("move_shapes: expected " + std::to_string(state_->shapes.size()) + " capsules, got " +
                std::to_string(shapes.size()));
  validate(shapes);
  state_->shapes.assign(shapes.begin(), shapes.end());
}

ContactSample ContactProbe::probe(std::span<const double> cloth_positions) const {
  const State& state = *state_;
  if (cloth_positions.size() != 3 * state.vertices)
    throw Error("contact probe: expected " + std::to_string(state.vertices) + " vertices, got " +
                std::to_string(cloth_positions.size() / 3));
  if (!all_finite(cloth_positions)) return {kMissing, kMissing};
  const TriangleMeshView cloth{cloth_positions, state.triangles};
  if (!state.mesh) return state.in_shapes(cloth);
  return {contour(cloth, state.mesh->tree).length_m, has_inside() ? state.depth_in_mesh(cloth) : kMissing};
}

bool ContactProbe::has_inside() const { return !state_->mesh || state_->mesh->has_inside; }

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
