#include "plugin/scene_view.hpp"

#include <algorithm>
#include <limits>

namespace clothbench::plugin {
namespace {

// Capsules and vectors are shown where they lie.
static_assert(sizeof(Capsule) == 7 * sizeof(double) && sizeof(Vec3) == 3 * sizeof(double));
static_assert(static_cast<int>(Collider::Shape::Plane) == CLOTHBENCH_SHAPE_PLANE &&
              static_cast<int>(Collider::Shape::Mesh) == CLOTHBENCH_SHAPE_MESH);

/// The piece of cloth that a skip edge stands for, on a grid of even cells.
EdgeCell skip_cell(const Cloth& c, const Edge& e) {
  const bool along_u = e.b - e.a == 2;
  return {e.rest_m / 2, along_u ? c.dv() : c.du()};
}

template <std::size_t N, class From>
void copy(double (&to)[N], const From& from) {
  std::copy(std::begin(from), std::end(from), to);
}

}  // namespace

SceneView::SceneView(const Scene& s)
    : scene_(s), position_(initial_positions(s)), velocity_(initial_velocities(s)), mass_(vertex_masses(s)) {
  for (const auto& t : clothbench::triangles(s.cloth)) triangles_.insert(triangles_.end(), t.begin(), t.end());
  add_edges(EdgeKind::Structural, structural_);
  if (s.needs.has(Feature::Shear)) add_edges(EdgeKind::Shear, shear_);
  if (s.needs.has(Feature::Bend)) add_edges(EdgeKind::SkipOne, skip_);
  add_colliders();
  ClothbenchScene& v = view_;
  v.struct_size = sizeof v;
  s.needs.for_each([&](Feature f) { v.needs |= 1u << static_cast<unsigned>(f); });
  v.columns = static_cast<std::uint32_t>(s.cloth.columns);
  v.rows = static_cast<std::uint32_t>(s.cloth.rows);
  v.vertex_count = static_cast<std::uint32_t>(s.cloth.vertex_count());
  v.width_m = s.cloth.width_m;
  v.height_m = s.cloth.height_m;
  v.areal_density_kg_per_m2 = s.cloth.areal_density_kg_per_m2;
  v.bending_rigidity_N_m = s.material.bending_rigidity_N_m;
  v.damping_per_s = s.material.damping_per_s;
  copy(v.gravity_m_per_s2, s.gravity_m_per_s2);
  v.frame_rate_hz = s.time.frame_rate_hz;
  v.frames = static_cast<std::uint32_t>(s.time.frames());
  v.position_m = position_.data();
  v.velocity_m_per_s = velocity_.data();
  v.mass_kg = mass_.data();
  const auto show = [](const auto& list, auto& pointer, std::uint32_t& count) {
    pointer = list.data();
    count = static_cast<std::uint32_t>(list.size());
  };
  show(triangles_, v.triangles, v.triangle_count);
  v.triangle_count /= 3;
  show(structural_, v.structural_edges, v.structural_count);
  show(shear_, v.shear_edges, v.shear_count);
  show(skip_, v.skip_edges, v.skip_count);
  show(s.pins.vertices, v.pins, v.pin_count);
  show(s.grips.vertices, v.grips, v.grip_count);
  show(colliders_, v.colliders, v.collider_count);
  v.poses = start_poses_.data();
  v.self_thickness_m = s.cloth.self_collision.thickness_m;
  v.self_friction = s.cloth.self_collision.friction;
}

void SceneView::add_edges(EdgeKind kind, std::vector<ClothbenchEdge>& out) {
  const bool skip = kind == EdgeKind::SkipOne;
  for (const Edge& e : edges(scene_.cloth, kind)) {
    const EdgeCell cell = skip ? skip_cell(scene_.cloth, e) : edge_cell(scene_.cloth, e);
    const double stiffness = skip ? 0 : membrane_stiffness(scene_, e).value_or(std::numeric_limits<double>::infinity());
    const double share = kind != EdgeKind::Shear && on_border(scene_.cloth, e) ? 0.5 : 1;
    out.push_back({e.a, e.b, e.rest_m, stiffness, cell.along_m, share * cell.across_m});
  }
}

void SceneView::add_colliders() {
  for (const Collider& c : scene_.colliders) {
    ClothbenchCollider v{};
    v.shape = static_cast<std::int32_t>(c.shape);
    v.moves = c.moves() ? 1 : 0;
    v.margin_m = c.margin_m;
    v.friction = c.friction;
    copy(v.center_m, c.center_m);
    copy(v.normal, c.normal);
    v.radius_m = c.radius_m;
    copy(v.half_extent_m, c.half_extent_m);
    for (std::size_t k = 0; k < 9; ++k) v.axes[k] = c.axes[k / 3][k % 3];
    v.capsule_count = static_cast<std::uint32_t>(c.capsules.size());
    if (c.mesh) {
      v.vertex_count = static_cast<std::uint32_t>(c.mesh->vertex_count());
      v.triangle_count = static_cast<std::uint32_t>(c.mesh->triangles.size());
      v.triangles = c.mesh->triangles.empty() ? nullptr : c.mesh->triangles.front().data();
      v.closed = c.mesh->closed ? 1 : 0;
    }
    colliders_.push_back(v);
  }
  poses_.resize(colliders_.size());
  vertices_.resize(colliders_.size());
  pose(scene_.motion.empty() ? nullptr : &scene_.motion.front());
  start_vertices_ = vertices_;
  start_poses_ = poses_;
  for (std::size_t k = 0; k < poses_.size(); ++k)
    if (!start_vertices_[k].empty()) start_poses_[k].vertices_m = start_vertices_[k].data();
}

void SceneView::pose(const FrameMotion* motion) {
  for (std::size_t k = 0; k < scene_.colliders.size(); ++k) {
    const Collider& c = scene_.colliders[k];
    const ColliderPose* now = motion != nullptr && k < motion->colliders.size() ? &motion->colliders[k] : nullptr;
    const std::vector<Capsule>& capsules = now != nullptr && !now->capsules.empty() ? now->capsules : c.capsules;
    poses_[k].capsules = capsules.empty() ? nullptr : capsules.front().a_m.data();
    if (!c.mesh) continue;
    if (c.mesh->skinned() && now != nullptr) vertices_[k] = posed_positions(*c.mesh, *now);
    poses_[k].vertices_m = c.mesh->skinned() && now != nullptr ? vertices_[k].data() : c.mesh->positions.data();
  }
}

const ClothbenchFrame* SceneView::frame(const FrameInput& in) {
  if (in.motion != nullptr) pose(in.motion);
  frame_ = {};
  frame_.struct_size = sizeof frame_;
  frame_.index = in.index;
  frame_.time_s = in.time_s;
  frame_.dt_s = in.dt_s;
  frame_.poses = poses_.data();
  if (in.motion != nullptr && !in.motion->grip_position_m.empty()) {
    frame_.grip_position_m = in.motion->grip_position_m.front().data();
    frame_.grip_held = in.motion->grip_held.data();
  }
  return &frame_;
}

}  // namespace clothbench::plugin
