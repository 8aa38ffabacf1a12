#include "metrics/contact/contact_probe.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "metrics/contact/contour.hpp"
#include "metrics/contact/tunnel.hpp"

namespace clothbench::contact {
namespace {

constexpr ContactSample kUnknown{kMissing, kMissing, kMissing, kMissing, kMissing, kMissing,
                                 kMissing, kMissing, kMissing, kMissing, kMissing};

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Triangles copy(std::span<const std::array<std::uint32_t, 3>> t) { return {t.begin(), t.end()}; }

std::vector<double> areas_of(const TriangleMeshView& cloth) {
  validate(cloth, "contact cloth");
  std::vector<double> areas = vertex_areas(cloth);
  if (!std::any_of(areas.begin(), areas.end(), [](double a) { return a > 0; }))
    throw Error("contact cloth: expected at least one triangle with area");
  return areas;
}

void validate(std::span<const Capsule> shapes) {
  for (std::size_t k = 0; k < shapes.size(); ++k)
    if (!shapes[k].a.allFinite() || !shapes[k].b.allFinite() || !(shapes[k].radius_m > 0) ||
        !std::isfinite(shapes[k].radius_m))
      throw Error("contact capsule " + std::to_string(k) + ": expected finite ends and a positive radius");
}

/// An object made of triangles, with its current positions and those at the last probe.
struct MeshObject {
  MeshObject(const TriangleMeshView& mesh, Solid solid)
      : triangles(copy(mesh.triangles)),
        positions(mesh.positions.begin(), mesh.positions.end()),
        tree(mesh),
        welded(welded_vertices(mesh)),
        border(mesh, welded),
        closed(is_closed(mesh, welded)),
        has_inside(solid == Solid::Nearly || (solid == Solid::Auto && closed)) {}

  TriangleMeshView view(const std::vector<double>& at) const { return {at, triangles}; }

  Triangles triangles;
  std::vector<double> positions, positions_before;  ///< the latter empty if it hasn't moved
  TriangleTree tree;
  std::vector<std::uint32_t> welded;
  Border border;
  bool closed, has_inside;
};

}  // namespace

struct ContactProbe::State {
  explicit State(const TriangleMeshView& cloth)
      : triangles(copy(cloth.triangles)),
        areas(areas_of(cloth)),
        mesh_depth(cloth),
        links(edges_of(cloth.triangles)),
        history(cloth.vertex_count(), links) {}

  void advance(std::span<const double> positions, bool contour);
  void probe_mesh(const TriangleMeshView& cloth, ContactSample&);
  void probe_shapes(const TriangleMeshView& cloth, ContactSample&) const;
  void set(const Contour& c, ContactSample& s) const {
    s.contour_length_m = c.length_m;
    s.pairs = static_cast<double>(c.pairs);
    s.cloth_fraction = static_cast<double>(c.cloth_triangles) / static_cast<double>(triangles.size());
  }
  static void set(const Depth& d, ContactSample& s) {
    s.depth_max_m = d.max_m;
    s.depth_vertex_max_m = d.vertex_max_m;
    s.depth_p99_m = d.p99_m;
    s.depth_mean_m = d.mean_m;
    s.area_m2 = d.area_m2;
    s.area_fraction = d.area_fraction;
  }

  Triangles triangles;
  std::vector<double> areas;
  MeshDepth mesh_depth;
  std::vector<Link> links;
  TunnelHistory history;
  std::vector<double> cloth_before;  ///< empty before the first probe
  bool history_lost = false, contour_before = false;
  std::optional<MeshObject> mesh;
  std::vector<Capsule> shapes;
};

void ContactProbe::State::advance(std::span<const double> positions, bool contour) {
  const std::vector<double>& from = mesh->positions_before.empty() ? mesh->positions : mesh->positions_before;
  const StepEvidence evidence{
      [either = contour || contour_before] { return either; },
      [&](const Point<3>& p, const Point<3>& q) { return mesh->border.out_of_reach(p, q, from, mesh->positions); }};
  contour_before = contour;
  if (!cloth_before.empty()) {
    if (mesh->positions_before.empty())
      history.advance(cloth_before, positions, mesh->tree, evidence);
    else
      history.advance(cloth_before, positions,
                      SweptMesh(mesh->view(mesh->positions_before), mesh->view(mesh->positions), mesh->welded),
                      evidence);
  }
  cloth_before.assign(positions.begin(), positions.end());
}

void ContactProbe::State::probe_mesh(const TriangleMeshView& cloth, ContactSample& s) {
  set(contour(cloth, mesh->tree), s);
  if (!history_lost) {
    advance(cloth.positions, s.contour_length_m > 0);
    s.tunnelled_fraction = history.fraction(areas);
    s.tunnelled_depth_max_m = 0;
    for (std::size_t i = 0; i < cloth.vertex_count(); ++i)
      if (history.counts()[i] != 0)
        s.tunnelled_depth_max_m = std::max(s.tunnelled_depth_max_m, mesh->tree.distance(cloth.vertex(i)));
  }
  if (mesh->has_inside) set(mesh_depth(cloth, mesh->tree, InsideTest(mesh->tree, mesh->closed)), s);
}

void ContactProbe::State::probe_shapes(const TriangleMeshView& cloth, ContactSample& s) const {
  const ShapesResult result = shapes_contact(cloth, shapes);
  set(result.contour, s);
  set(result.depth, s);
  double inside = 0, all = 0;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    all += areas[i];
    if (result.inside[i]) inside += areas[i];
  }
  s.tunnelled_fraction = inside / all;
  s.tunnelled_depth_max_m = result.depth.vertex_max_m;
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
  if (positions.size() != mesh.positions.size())
    throw Error("move_object: expected " + std::to_string(mesh.positions.size() / 3) + " vertices, got " +
                std::to_string(positions.size() / 3));
  std::vector<double> moved(positions.begin(), positions.end());
  mesh.tree = TriangleTree(mesh.view(moved));
  // If the object moves twice between two probes, its path still begins at the positions of the last probe.
  if (mesh.positions_before.empty()) mesh.positions_before = std::move(mesh.positions);
  mesh.positions = std::move(moved);
}

void ContactProbe::move_shapes(std::span<const Capsule> shapes) {
  if (state_->mesh) throw Error("move_shapes: expected a probe of capsules, this one has a mesh");
  if (shapes.size() != state_->shapes.size())
    throw Error("move_shapes: expected " + std::to_string(state_->shapes.size()) + " capsules, got " +
                std::to_string(shapes.size()));
  validate(shapes);
  state_->shapes.assign(shapes.begin(), shapes.end());
}

ContactSample ContactProbe::probe(std::span<const double> cloth_positions) {
  State& state = *state_;
  if (cloth_positions.size() != 3 * state.areas.size())
    throw Error("contact probe: expected " + std::to_string(state.areas.size()) + " vertices, got " +
                std::to_string(cloth_positions.size() / 3));
  ContactSample sample = kUnknown;
  if (all_finite(cloth_positions)) {
    const TriangleMeshView cloth{cloth_positions, state.triangles};
    state.mesh ? state.probe_mesh(cloth, sample) : state.probe_shapes(cloth, sample);
  } else {
    state.history_lost = true;
  }
  if (state.mesh) state.mesh->positions_before.clear();
  return sample;
}

void ContactProbe::reset() {
  state_->history = TunnelHistory(state_->areas.size(), state_->links);
  state_->cloth_before.clear();
  state_->history_lost = false;
}

std::span<const int> ContactProbe::crossing_counts() const {
  return state_->mesh ? state_->history.counts() : std::span<const int>();
}

bool ContactProbe::has_inside() const { return !state_->mesh || state_->mesh->has_inside; }

}  // namespace clothbench::contact
