#include "common/colliders.hpp"

#include <cstring>

#include "clothbench/error.hpp"

namespace clothbench::pbd_gpu {
namespace {

using vulkan::Buffer;

template <class T>
void write_to(const Buffer& host, const std::vector<T>& items) {
  std::memcpy(host.mapped(), items.data(), items.size() * sizeof(T));
}

float number(double x) { return static_cast<float>(x); }

vec4 relative(const Vec3& at, const Vec3& origin, double w) {
  return {number(at[0] - origin[0]), number(at[1] - origin[1]), number(at[2] - origin[2]), number(w)};
}
vec4 direction(const Vec3& d, double w) { return relative(d, {}, w); }

}  // namespace

ColliderBuffers::ColliderBuffers(FrameBuilder& frame, const Scene& scene, Vec3 origin_m, bool as_convex_shapes)
    : frame_(frame), scene_(scene), origin_m_(origin_m), as_convex_shapes_(as_convex_shapes) {
  planes = add_shapes<PlaneShape>(Collider::Shape::Plane, BIND_PLANES, "collider planes", [&](const Collider& c) {
    double offset = 0;
    for (std::size_t k = 0; k < 3; ++k) offset += c.normal[k] * (c.center_m[k] - origin_m_[k]);
    return PlaneShape{direction(c.normal, offset), number(c.margin_m), number(c.friction)};
  });
  if (!as_convex_shapes) add_static_meshes();
  const FeatureSet kinematic_kinds = scene.needs & FeatureSet{Feature::Capsules, Feature::MovingMesh};
  if (kinematic_kinds.empty()) return;
  at_ = scene.motion.at(0);
  stage_upload_ = frame_.add_stage("UploadColliders", kinematic_kinds);
  if (kinematic_kinds.has(Feature::Capsules)) add_capsules();
  if (kinematic_kinds.has(Feature::MovingMesh)) {
    kinematic_meshes = add_meshes("moving collider mesh", true);
    add_skinning();
  }
}

void ColliderBuffers::add_static_meshes() {
  spheres = add_shapes<SphereShape>(Collider::Shape::Sphere, BIND_SPHERES, "collider spheres", [&](const Collider& c) {
    return SphereShape{relative(c.center_m, origin_m_, 0), number(c.radius_m), number(c.margin_m), number(c.friction)};
  });
  boxes = add_shapes<BoxShape>(Collider::Shape::Box, BIND_BOXES, "collider boxes", [&](const Collider& c) {
    return BoxShape{relative(c.center_m, origin_m_, 0),
                    direction(c.axes[0], c.half_extent_m[0]),
                    direction(c.axes[1], c.half_extent_m[1]),
                    direction(c.axes[2], c.half_extent_m[2]),
                    number(c.margin_m),
                    number(c.friction)};
  });
  static_meshes = add_meshes("collider mesh", false);
}

template <class Shape, class Fill>
ShapeBuffer ColliderBuffers::add_shapes(Collider::Shape kind, int binding, const char* name, Fill fill) {
  std::vector<Shape> shapes;
  ShapeBuffer result;
  for (const Collider& c : scene_.colliders)
    if (c.shape == kind) {
      shapes.push_back(fill(c));
      result.friction |= c.friction > 0;
    }
  if (shapes.empty()) return result;
  result.count = static_cast<std::uint32_t>(shapes.size());
  result.buffer = &frame_.add_buffer(binding, name, shapes);
  return result;
}

MeshBuffers ColliderBuffers::add_meshes(const std::string& kind, bool kinematic) {
  MeshBuffers result;
  std::vector<vec4> positions;
  std::vector<uvec4> triangles;
  for (std::size_t k = 0; k < scene_.colliders.size(); ++k) {
    const Collider& c = scene_.colliders[k];
    if (c.shape != Collider::Shape::Mesh || c.moves() != kinematic) continue;
    const auto first_vertex = static_cast<std::uint32_t>(positions.size());
    const auto first_triangle = static_cast<std::uint32_t>(triangles.size());
    const std::vector<double> at = kinematic ? posed_positions(*c.mesh, at_.colliders.at(k)) : c.mesh->positions;
    for (std::size_t v = 0; v < c.mesh->vertex_count(); ++v)
      positions.push_back(relative({at[3 * v], at[3 * v + 1], at[3 * v + 2]}, origin_m_, 0));
    for (const auto& t : c.mesh->triangles)
      triangles.push_back({first_vertex + t[0], first_vertex + t[1], first_vertex + t[2], static_cast<uint>(k)});
    result.ranges.push_back({k, first_vertex, static_cast<std::uint32_t>(c.mesh->vertex_count()), first_triangle,
                             static_cast<std::uint32_t>(c.mesh->triangles.size()), number(c.margin_m),
                             number(c.friction)});
  }
  if (result.ranges.empty()) return result;
  result.positions =
      &frame_.add_buffer(kinematic ? BIND_KINEMATIC_END : BIND_STATIC_VERTICES, kind + " positions", positions);
  if (as_convex_shapes_)
    result.start_positions = &frame_.add_buffer(BIND_KINEMATIC_START, kind + " start positions", positions);
  else
    result.triangles = &frame_.add_buffer(FrameBuilder::kUnbound, kind + " triangles", triangles);
  return result;
}

std::vector<CapsuleShape> ColliderBuffers::capsules_between(const FrameMotion& start, const FrameMotion& end) const {
  std::vector<CapsuleShape> all;
  for (std::size_t k = 0; k < scene_.colliders.size(); ++k) {
    const Collider& c = scene_.colliders[k];
    if (c.shape != Collider::Shape::Capsules) continue;
    for (std::size_t i = 0; i < c.capsules.size(); ++i) {
      const Capsule &s = start.colliders.at(k).capsules.at(i), &e = end.colliders.at(k).capsules.at(i);
      all.push_back({relative(s.a_m, origin_m_, e.radius_m), relative(s.b_m, origin_m_, c.margin_m),
                     relative(e.a_m, origin_m_, e.radius_m + c.margin_m), relative(e.b_m, origin_m_, c.friction)});
    }
  }
  return all;
}

void ColliderBuffers::add_capsules() {
  const std::vector<CapsuleShape> all = capsules_between(at_, at_);
  capsules.count = static_cast<std::uint32_t>(all.size());
  for (const Collider& c : scene_.colliders)
    capsules.friction |= c.shape == Collider::Shape::Capsules && c.friction > 0;
  capsules.buffer = &frame_.add_buffer(BIND_CAPSULES, "collider capsules", all);
  capsules_host_ = &frame_.add_host_buffer("collider capsules (upload)", capsules.buffer->bytes());
}

/// The translations include the shift of origin. Weights sum to 1, so skinned positions are relative to the origin.
std::vector<JointMatrix> ColliderBuffers::matrices(const FrameMotion& motion) const {
  std::vector<JointMatrix> all;
  for (const MeshRange& range : kinematic_meshes.ranges)
    for (const Affine& m : motion.colliders.at(range.collider).joints) {
      const auto row = [&](std::size_t r) { return direction({m[r][0], m[r][1], m[r][2]}, m[r][3] - origin_m_[r]); };
      all.push_back({row(0), row(1), row(2)});
    }
  return all;
}

void ColliderBuffers::add_skinning() {
  std::vector<SkinVertex> vertices;
  std::uint32_t first_joint = 0;
  for (const MeshRange& range : kinematic_meshes.ranges) {
    const ColliderMesh& mesh = *scene_.colliders[range.collider].mesh;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      const auto& j = mesh.joints[v];
      const auto& w = mesh.weights[v];
      vertices.push_back(
          {relative({mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]}, {}, 1),
           {w[0], w[1], w[2], w[3]},
           {first_joint + j[0], first_joint + j[1], first_joint + j[2], first_joint + j[3]}});
    }
    first_joint += static_cast<std::uint32_t>(mesh.joint_count);
  }
  skinned_vertices_ = static_cast<std::uint32_t>(vertices.size());
  frame_.add_buffer(BIND_SKIN, "collider skin", vertices);
  const std::uint64_t bytes = first_joint * sizeof(JointMatrix);
  joints_ = &frame_.add_buffer(BIND_JOINTS, "collider joints", bytes);
  joints_host_ = &frame_.add_host_buffer("collider joints (upload)", bytes);
  stage_skin_ = frame_.add_stage("SkinHand", {Feature::MovingMesh});
  skin_ =
      frame_.add_kernel(stage_skin_, as_convex_shapes_ ? "skin_mesh_keep_start" : "skin_mesh", sizeof(SkinConstants));
}

void ColliderBuffers::record() {
  if (capsules_host_ != nullptr) frame_.copy(stage_upload_, *capsules_host_, *capsules.buffer);
  if (joints_host_ == nullptr) return;
  frame_.copy(stage_upload_, *joints_host_, *joints_);
  frame_.dispatch(*skin_, skinned_vertices_, SkinConstants{skinned_vertices_});
}

void ColliderBuffers::reset() {
  if (stage_upload_ >= 0) at_ = scene_.motion.at(0);
}

void ColliderBuffers::write(const FrameMotion* end) {
  if (stage_upload_ < 0) return;
  const FrameMotion& to = end != nullptr ? *end : at_;
  if (to.colliders.size() != scene_.colliders.size())
    throw Error("motion of " + std::to_string(to.colliders.size()) + " colliders; expected " +
                std::to_string(scene_.colliders.size()));
  if (capsules_host_ != nullptr) write_to(*capsules_host_, capsules_between(at_, to));
  if (joints_host_ != nullptr) write_to(*joints_host_, matrices(to));
  if (end != nullptr) at_ = *end;
}

GripBuffer::GripBuffer(FrameBuilder& frame, const Scene& scene, Vec3 origin_m, std::uint32_t layers)
    : frame_(frame), scene_(scene), origin_m_(origin_m), layers_(layers) {
  const std::vector<double> mass = vertex_masses(scene);
  for (std::uint32_t v : scene.grips.vertices) free_inverse_mass_.push_back(static_cast<float>(1 / mass[v]));
  at_ = scene.motion.at(0);
  held_ = at_.grip_held;
  const std::vector<GripVertex> all = entries(at_, at_);
  grips_ = &frame_.add_buffer(BIND_GRIPS, "grips", all);
  host_ = &frame_.add_host_buffer("grips (upload)", grips_->bytes());
  stage_upload_ = frame_.add_stage("UploadGrips", {Feature::MovingPins});
}

std::vector<GripVertex> GripBuffer::entries(const FrameMotion& start, const FrameMotion& end) const {
  const std::vector<std::uint32_t>& vertices = scene_.grips.vertices;
  if (start.grip_position_m.size() != vertices.size() || end.grip_position_m.size() != vertices.size() ||
      start.grip_held.size() != vertices.size())
    throw Error("motion of " + std::to_string(end.grip_position_m.size()) + " held vertices; expected " +
                std::to_string(vertices.size()));
  std::vector<GripVertex> all;
  for (std::uint32_t layer = 0; layer < layers_; ++layer)
    for (std::size_t k = 0; k < vertices.size(); ++k)
      all.push_back({relative(start.grip_position_m[k], origin_m_, 0), relative(end.grip_position_m[k], origin_m_, 0),
                     vertices[k] + layer * static_cast<std::uint32_t>(scene_.cloth.vertex_count()), start.grip_held[k],
                     free_inverse_mass_[k]});
  return all;
}

const FrameKernel* GripBuffer::add_kernel(const Buffer& positions) {
  if (stage_move_ < 0) stage_move_ = frame_.add_stage("MoveGrips", {Feature::MovingPins});
  return frame_.add_kernel(stage_move_, "move_grips", sizeof(GripConstants), {}, kGroupSize,
                           {{BIND_POSITIONS, &positions}});
}

void GripBuffer::record_upload() { frame_.copy(stage_upload_, *host_, *grips_); }

void GripBuffer::record_move(const FrameKernel& kernel, double fraction, double frame_s) {
  const auto n = static_cast<std::uint32_t>(layers_ * scene_.grips.vertices.size());
  frame_.dispatch(kernel, n, GripConstants{n, static_cast<float>(fraction), static_cast<float>(1 / frame_s)});
}

void GripBuffer::reset() {
  at_ = scene_.motion.at(0);
  held_ = at_.grip_held;
}

bool GripBuffer::write(const FrameMotion* end) {
  const FrameMotion& to = end != nullptr ? *end : at_;
  write_to(*host_, entries(at_, to));
  // A vertex is held during frames that start with its flag set: released at t, it is free from t on.
  const bool changed = held_ != at_.grip_held;
  held_ = at_.grip_held;
  if (end != nullptr) at_ = *end;
  return changed;
}

}  // namespace clothbench::pbd_gpu
