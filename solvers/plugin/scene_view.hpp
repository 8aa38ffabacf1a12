#pragma once
#include <vector>

#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"
#include "clothbench_plugin.h"

namespace clothbench::plugin {

/// A scene in the structs of the C interface. The scene must outlive the view and stay at its address.
class SceneView {
 public:
  explicit SceneView(const Scene&);
  SceneView(const SceneView&) = delete;
  SceneView& operator=(const SceneView&) = delete;
  const ClothbenchScene* scene() const { return &view_; }
  /// The frame's end; valid until the next call. Skins moving meshes, which counts as solver time as in all solvers.
  const ClothbenchFrame* frame(const FrameInput&);

 private:
  void add_colliders();
  void add_edges(EdgeKind, std::vector<ClothbenchEdge>&);
  void pose(const FrameMotion*);

  const Scene& scene_;
  ClothbenchScene view_{};
  ClothbenchFrame frame_{};
  std::vector<double> position_, velocity_, mass_;
  std::vector<std::uint32_t> triangles_;
  std::vector<ClothbenchEdge> structural_, shear_, skip_;
  std::vector<ClothbenchCollider> colliders_;
  std::vector<ClothbenchPose> start_poses_, poses_;
  std::vector<std::vector<double>> start_vertices_, vertices_;  ///< of meshes, one a collider
};

}  // namespace clothbench::plugin
