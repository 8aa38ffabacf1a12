#include "plugin/scene_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "clothbench_plugin.h"

namespace clothbench::plugin {
namespace {

// The C interface points to capsules and vectors without copying them.
static_assert(sizeof(Capsule) == 7 * sizeof(double) && sizeof(Vec3) == 3 * sizeof(double));
static_assert(static_cast<int>(Collider::Shape::Plane) == CLOTHBENCH_SHAPE_PLANE &&
              static_cast<int>(Collider::Shape::Mesh) == CLOTHBENCH_SHAPE_MESH);

template <std::size_t N, class From>
void copy(double (&to)[N], const From& from) {
  std::copy(std::begin(from), std::end(from), to);
}

/// The cloth at rest in world coordinates [m], 3 numbers per vertex: flat, whatever its start.
std::vector<double> rest_positions(const Cloth& c) {
  Scene flat;
  flat.cloth = c;
  flat.cloth.span_m = flat.cloth.drape_radius_m = 0;
  flat.cloth.start = {};
  return initial_positions(flat);
}

/// Whether one of the points, x y z each, moved by more than `distance_m`.
bool moved(const double* before, const double* now, std::size_t points, double distance_m) {
  for (const double *a = before, *b = now; points > 0; --points, a += 3, b += 3)
    if (!(std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]) <= distance_m)) return true;
  return false;
}

}  // namespace

SceneView::SceneView(const Scene& s)
    : scene_(s),
      position_(initial_positions(s)),
      velocity_(initial_velocities(s)),
      mass_(vertex_masses(s)),
      rest_(rest_positions(s.cloth)) {
  for (const auto& t : clothbench::triangles(s.cloth)) triangles_.insert(triangles_.end(), t.begin(), t.end());
  add_edges(EdgeKind::Structural, structural_);
  if (s.needs.has(Feature::Shear)) add_edges(EdgeKind::Shear, shear_);
  if (s.needs.has(Feature::Bend)) add_edges(EdgeKind::SkipOne, skip_);
  add_colliders();
  ClothbenchScene& v = view_;
  v.needs = s.needs.bits();
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
  v.poses = start_.poses.data();
  v.rest_position_m = rest_.data();
  v.self_thickness_m = s.cloth.self_collision.thickness_m;
  v.self_friction = s.cloth.self_collision.friction;
}

void SceneView::add_edges(EdgeKind kind, std::vector<ClothbenchEdge>& out) {
  constexpr double kInextensible = std::numeric_limits<double>::infinity();
  const Cloth& c = scene_.cloth;
  const bool skip = kind == EdgeKind::SkipOne;
  const std::vector<Edge> all = edges(c, kind);
  std::vector<std::optional<double>> Y(all.size(), 0.0);
  if (kind == EdgeKind::Structural) Y = edge_stiffnesses(scene_);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Edge& e = all[k];
    // A skip edge stands for the bending of a strip that is one cell wide, on an even grid.
    const EdgeCell cell = skip ? EdgeCell{e.rest_m / 2, e.b - e.a == 2 ? c.dv() : c.du()} : edge_cell(c, e);
    if (kind == EdgeKind::Shear) Y[k] = membrane_stiffness(scene_, e);
    const double spring = skip ? 0 : Y[k] ? spring_N_per_m(scene_, e, *Y[k]) : kInextensible;
    const double share = kind != EdgeKind::Shear && on_border(c, e) ? 0.5 : 1;
    out.push_back({e.a, e.b, e.rest_m, Y[k].value_or(kInextensible), cell.along_m, share * cell.across_m, spring});
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
  pose(scene_.motion.empty() ? nullptr : &scene_.motion.front(), start_);
}

void SceneView::pose(const FrameMotion* motion, Posed& out) const {
  out.poses.resize(colliders_.size());
  out.vertices.resize(colliders_.size());
  for (std::size_t k = 0; k < scene_.colliders.size(); ++k) {
    const Collider& c = scene_.colliders[k];
    const ColliderPose* now = motion != nullptr && k < motion->colliders.size() ? &motion->colliders[k] : nullptr;
    const std::vector<Capsule>& capsules = now != nullptr && !now->capsules.empty() ? now->capsules : c.capsules;
    out.poses[k].capsules = capsules.empty() ? nullptr : capsules.front().a_m.data();
    if (!c.mesh) continue;
    if (c.mesh->skinned() && now != nullptr) out.vertices[k] = posed_positions(*c.mesh, *now);
    out.poses[k].vertices_m = c.mesh->skinned() && now != nullptr ? out.vertices[k].data() : c.mesh->positions.data();
  }
}

/// Poses at the end of the previous frame. In a run, `now_` contains them, so call this before `now_` is overwritten.
const SceneView::Posed& SceneView::pose_before(const FrameInput& in) {
  if (in.index <= 0) return start_;
  std::swap(before_, now_);
  if (posed_ != in.index - 1) pose(scene_.motion_after(in.index - 1), before_);
  return before_;
}

void SceneView::mark_teleports(const FrameInput& in) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const Jump& j : scene_.jumps)
    if (j.frame == in.index + 1) least_m = std::min(least_m, j.distance_m / 2);
  if (std::isinf(least_m)) return;
  collider_teleports_.assign(colliders_.size(), 0);
  grip_teleports_.assign(scene_.grips.vertices.size(), 0);
  for (std::size_t k = 0; k < colliders_.size(); ++k) {
    const ClothbenchPose &a = frame_.poses_before[k], &b = frame_.poses[k];
    bool any = false;
    for (std::size_t c = 0; c < colliders_[k].capsule_count; ++c)
      any = any || moved(a.capsules + 7 * c, b.capsules + 7 * c, 2, least_m);
    if (any || moved(a.vertices_m, b.vertices_m, colliders_[k].vertex_count, least_m)) collider_teleports_[k] = 1;
  }
  const FrameMotion* before = in.index > 0 ? scene_.motion_after(in.index - 1) : &scene_.motion.front();
  for (std::size_t g = 0; g < grip_teleports_.size() && !before->grip_position_m.empty(); ++g)
    grip_teleports_[g] = moved(before->grip_position_m[g].data(), frame_.grip_position_m + 3 * g, 1, least_m);
  frame_.collider_teleports = collider_teleports_.data();
  frame_.grip_teleports = grip_teleports_.data();
}

const ClothbenchFrame* SceneView::frame(const FrameInput& in) {
  frame_ = {};
  frame_.index = in.index;
  frame_.time_s = in.time_s;
  frame_.dt_s = in.dt_s;
  frame_.poses = start_.poses.data();
  frame_.poses_before = start_.poses.data();
  if (in.motion == nullptr) return &frame_;
  frame_.poses_before = pose_before(in).poses.data();
  pose(in.motion, now_);
  posed_ = in.index;
  frame_.poses = now_.poses.data();
  if (!in.motion->grip_position_m.empty()) {
    frame_.grip_position_m = in.motion->grip_position_m.front().data();
    frame_.grip_held = in.motion->grip_held.data();
  }
  if (!scene_.jumps.empty()) mark_teleports(in);
  return &frame_;
}

const ClothbenchRestart* SceneView::restart(const ClothState& state, const FrameInput& last) {
  restart_ = {last.index, last.time_s, state.position.data(), state.velocity.data(), start_.poses.data(),
              nullptr,    nullptr};
  const FrameMotion* motion = last.index < 0 && !scene_.motion.empty() ? &scene_.motion.front() : last.motion;
  if (motion == nullptr) return &restart_;
  pose(motion, now_);
  posed_ = last.index;
  restart_.poses = now_.poses.data();
  if (motion->grip_position_m.empty()) return &restart_;
  restart_.grip_position_m = motion->grip_position_m.front().data();
  restart_.grip_held = motion->grip_held.data();
  return &restart_;
}

}  // namespace clothbench::plugin
