#pragma once
#include <cstdint>
#include <vector>

#include "clothbench/scene.hpp"
#include "common/frame_builder.hpp"

namespace clothbench::pbd_gpu {

/// Ranges of one mesh collider in the buffers of its kind, and its contact parameters.
struct MeshRange {
  std::size_t collider = 0;  ///< index in Scene::colliders; also .w of each of its triangles
  std::uint32_t first_vertex = 0, vertices = 0, first_triangle = 0, triangles = 0;
  float margin_m = 0, friction = 0;
};

/// All meshes of one kind, one after another; indices count from the first vertex of the first mesh. Null and empty if
/// the scene has no mesh of this kind.
struct MeshBuffers {
  std::vector<MeshRange> ranges;
  const vulkan::Buffer* triangles = nullptr;        ///< uvec4 each: corners, collider; null if as_convex_shapes
  const vulkan::Buffer* positions = nullptr;        ///< vec4 each; if kinematic, at the frame's end
  const vulkan::Buffer* start_positions = nullptr;  ///< at the frame's start; only if kinematic and as_convex_shapes
};

/// Shapes of one kind: `count` structs of gpu_types.h.
struct ShapeBuffer {
  const vulkan::Buffer* buffer = nullptr;
  std::uint32_t count = 0;
  bool friction = false;  ///< at least one shape has friction
};

/// Colliders on the device: one buffer for each kind of collider in the scene (pbd-gpu/README.md).
class ColliderBuffers {
 public:
  /// Adds buffers, the stages the scene needs and their kernels to `frame`. Positions are relative to `origin_m`,
  /// subtracted in double. `as_convex_shapes`: the solver uses convex shapes (ConvexShapes) and adds them itself. Then
  /// planes are the only static shapes with a buffer, and kinematic meshes also keep their positions at the frame's
  /// start, as capsules always do.
  ColliderBuffers(FrameBuilder& frame, const Scene& scene, Vec3 origin_m, bool as_convex_shapes);

  ShapeBuffer planes, spheres, boxes, capsules;
  MeshBuffers static_meshes, kinematic_meshes;

  bool written_each_frame() const { return stage_upload_ >= 0; }

  /// Records upload and skinning; must come before any kernel that reads kinematic colliders.
  void record();
  /// The host's part of a reset: the next frame starts at motion[0].
  void reset();
  /// Call before a frame is submitted: kinematic colliders move from the last call's `end` to this; null: no motion.
  void write(const FrameMotion* end);

 private:
  template <class Shape, class Fill>
  ShapeBuffer add_shapes(Collider::Shape kind, int binding, const char* name, Fill fill);
  MeshBuffers add_meshes(const std::string& kind, bool kinematic);
  void add_static_meshes();
  void add_capsules();
  void add_skinning();
  std::vector<CapsuleShape> capsules_between(const FrameMotion& start, const FrameMotion& end) const;
  std::vector<JointMatrix> matrices(const FrameMotion&) const;

  FrameBuilder& frame_;
  const Scene& scene_;
  const Vec3 origin_m_;
  FrameMotion at_;  ///< end of the last frame
  int stage_upload_ = -1, stage_skin_ = -1;
  std::uint32_t skinned_vertices_ = 0;
  bool as_convex_shapes_ = false;
  const vulkan::Buffer *capsules_host_ = nullptr, *joints_host_ = nullptr, *joints_ = nullptr;
  const FrameKernel* skin_ = nullptr;
};

/// Attachments: substep s of n puts an attached vertex at (s + 1) / n of its path through the frame.
class GripBuffer {
 public:
  /// `layers` copies of the cloth's vertices lie one after another in the solver's buffers.
  GripBuffer(FrameBuilder& frame, const Scene& scene, Vec3 origin_m, std::uint32_t layers);

  /// Adds a kernel that sets position and velocity of attached vertices to the hand's, and .w of both to 0. For
  /// released vertices it only sets .w to the inverse mass. May be called for several buffers.
  const FrameKernel* add_kernel(const vulkan::Buffer& positions);
  void record_upload();
  /// `fraction` of the path through the frame, 0 to 1.
  void record_move(const FrameKernel&, double fraction, double frame_s);

  void reset();
  /// Like ColliderBuffers::write; true if a vertex was attached or released.
  bool write(const FrameMotion* end);

 private:
  std::vector<GripVertex> entries(const FrameMotion& start, const FrameMotion& end) const;

  FrameBuilder& frame_;
  const Scene& scene_;
  const Vec3 origin_m_;
  const std::uint32_t layers_;
  std::vector<float> free_inverse_mass_;  ///< one per Scene::grips.vertices
  FrameMotion at_;
  std::vector<std::uint8_t> held_;
  int stage_upload_ = -1, stage_move_ = -1;
  const vulkan::Buffer* host_ = nullptr;
  const vulkan::Buffer* grips_ = nullptr;
};

}  // namespace clothbench::pbd_gpu
