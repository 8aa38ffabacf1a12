#include "paper_contact.hpp"

#include <algorithm>

namespace clothbench::pbd_gpu {

namespace {

FeatureSet with_friction(Feature kind, bool friction) {
  FeatureSet serves = {kind};
  if (friction) serves.add(Feature::Friction);
  return serves;
}

std::vector<std::uint32_t> with_friction(bool friction) {
  PaperSpecialization s;
  s.FRICTION = friction ? 1 : 0;
  return s.by_number();
}

}  // namespace

PaperContact::PaperContact(FrameBuilder& frame, const ColliderBuffers& colliders, float mesh_depth_m,
                           float hand_depth_m)
    : frame_(frame) {
  add_shapes("SatisfySphereCollisions", colliders.spheres, Feature::Sphere, "satisfy_sphere_collisions",
             sizeof(SphereShape));
  add_shapes("SatisfyCubeCollisions", colliders.boxes, Feature::Box, "satisfy_cube_collisions", sizeof(BoxShape));
  add_meshes("SatisfyMeshCollisions", colliders.standing, Feature::StaticMesh, mesh_depth_m);
  add_meshes("SatisfyHandMeshCollisions", colliders.moving, Feature::MovingMesh, hand_depth_m);
  // Only the capsule at the frame's end is read: two of the four vec4.
  add_shapes("SatisfyCapsuleCollisions", colliders.capsules, Feature::Capsules, "satisfy_capsule_collisions", 32);
}

void PaperContact::add_shapes(const char* stage_name, const ShapeBuffer& shapes, Feature kind, const char* name,
                              std::uint32_t item_bytes) {
  if (shapes.count == 0) {
    frame_.leave_out(stage_name, "the scene has no " + std::string(name_of(kind)));
    return;
  }
  const int stage = frame_.add_stage(stage_name, with_friction(kind, shapes.friction));
  const FrameKernel* kernel =
      frame_.add_kernel(stage, name, sizeof(PaperContactConstants), with_friction(shapes.friction));
  passes_.push_back({kernel, {0, 0, shapes.count, 0, 0, 0}, item_bytes, shapes.friction});
}

void PaperContact::add_meshes(const char* stage_name, const MeshBuffers& meshes, Feature kind, float depth_m) {
  if (meshes.ranges.empty()) {
    frame_.leave_out(stage_name, "the scene has no " + std::string(name_of(kind)));
    return;
  }
  const bool friction =
      std::any_of(meshes.ranges.begin(), meshes.ranges.end(), [](const MeshRange& r) { return r.friction > 0; });
  const int stage = frame_.add_stage(stage_name, with_friction(kind, friction));
  const FrameKernel* kernel =
      frame_.add_kernel(stage, "satisfy_mesh_collisions", sizeof(PaperContactConstants), with_friction(friction),
                        kGroupSize, {{BIND_TRIANGLES, meshes.triangles}, {BIND_MESH_VERTICES, meshes.positions}});
  for (const MeshRange& r : meshes.ranges)
    passes_.push_back({kernel, {0, r.first_triangle, r.triangles, r.margin_m, depth_m, r.friction}, 64, friction});
}

void PaperContact::record(std::uint32_t particles) {
  const auto n = static_cast<double>(particles);
  for (Pass& pass : passes_) {
    pass.constants.particles = particles;
    const double each = static_cast<double>(pass.constants.count) * pass.item_bytes + (pass.friction ? 16 : 0);
    frame_.dispatch(*pass.kernel, particles, pass.constants, {(16 + each) * n, 16 * n});
  }
}

}  // namespace clothbench::pbd_gpu
