#pragma once
#include <vector>

#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"
#include "clothbench_plugin.h"

namespace clothbench::plugin {

/// A scene as the C interface shows it. The scene must outlive it; it is not to be moved once shown.
class SceneView {
 public:
  explicit SceneView(const Scene&);
  SceneView(const SceneView&) = delete;
  SceneView& operator=(const SceneView&) = delete;
  const ClothbenchScene* scene() const { return &view_; }
  /// The frame's end; valid until the next call. Skins moving meshes, which counts as the solver's time as everywhere.
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
