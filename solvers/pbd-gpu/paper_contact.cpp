#include "paper_contact.hpp"

#include <algorithm>

namespace clothbench::pbd_gpu {

using vulkan::Access;

namespace {

FeatureSet with_friction(Feature kind, bool friction) {
  FeatureSet serves = {kind};
  if (friction) serves.add(Feature::Friction);
  return serves;
}

}  // namespace

PaperContact::PaperContact(GpuSolver& solver, const ColliderBuffers& colliders, const vulkan::Buffer& predicted,
                           const vulkan::Buffer& positions, float mesh_depth_m, float hand_depth_m)
    : solver_(solver), predicted_(predicted), positions_(positions) {
  add_shapes("SatisfySphereCollisions", colliders.spheres, Feature::Sphere, shaders::kSatisfySphereCollisions,
             sizeof(SphereShape));
  add_shapes("SatisfyCubeCollisions", colliders.boxes, Feature::Box, shaders::kSatisfyCubeCollisions, sizeof(BoxShape));
  add_meshes("SatisfyMeshCollisions", colliders.standing, Feature::StaticMesh, mesh_depth_m);
  add_meshes("SatisfyHandMeshCollisions", colliders.moving, Feature::MovingMesh, hand_depth_m);
  // The end of the frame alone: two of the four vec4.
  add_shapes("SatisfyCapsuleCollisions", colliders.capsules, Feature::Capsules, shaders::kSatisfyCapsuleCollisions, 32);
}

void PaperContact::add_shapes(const char* stage_name, const ShapeBuffer& shapes, Feature kind, const Shader& shader,
                              std::uint32_t item_bytes) {
  if (shapes.count == 0) {
    solver_.leave_out(stage_name, "the scene has no " + std::string(name_of(kind)));
    return;
  }
  const int stage = solver_.add_stage(stage_name, with_friction(kind, shapes.friction));
  const vulkan::Kernel& kernel = solver_.add_kernel(
      stage, shader, {{shapes.buffer, Access::Read}, {&predicted_, Access::ReadWrite}, {&positions_, Access::Read}},
      sizeof(PaperContactConstants), {shapes.friction ? 1u : 0u});
  passes_.push_back({stage, &kernel, {0, 0, shapes.count, 0, 0, 0}, item_bytes, shapes.friction});
}

void PaperContact::add_meshes(const char* stage_name, const MeshBuffers& meshes, Feature kind, float depth_m) {
  if (meshes.ranges.empty()) {
    solver_.leave_out(stage_name, "the scene has no " + std::string(name_of(kind)));
    return;
  }
  const bool friction =
      std::any_of(meshes.ranges.begin(), meshes.ranges.end(), [](const MeshRange& r) { return r.friction > 0; });
  const int stage = solver_.add_stage(stage_name, with_friction(kind, friction));
  const vulkan::Kernel& kernel = solver_.add_kernel(stage, shaders::kSatisfyMeshCollisions,
                                                    {{meshes.triangles, Access::Read},
                                                     {&predicted_, Access::ReadWrite},
                                                     {&positions_, Access::Read},
                                                     {meshes.positions, Access::Read}},
                                                    sizeof(PaperContactConstants), {friction ? 1u : 0u});
  for (const MeshRange& r : meshes.ranges)
    passes_.push_back(
        {stage, &kernel, {0, r.first_triangle, r.triangles, r.margin_m, depth_m, r.friction}, 64, friction});
}

void PaperContact::record(std::uint32_t particles, std::int64_t free) {
  const auto n = static_cast<double>(particles), f = static_cast<double>(free);
  for (Pass& pass : passes_) {
    pass.constants.particles = particles;
    const double each = static_cast<double>(pass.constants.count) * pass.item_bytes + (pass.friction ? 16 : 0);
    solver_.dispatch(pass.stage, *pass.kernel, particles, pass.constants, {16 * n + each * f, 16 * f});
  }
}

}  // namespace clothbench::pbd_gpu
