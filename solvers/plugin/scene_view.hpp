#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "base/json_text.hpp"
#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"
#include "clothbench_plugin.h"

namespace clothbench::plugin {

/// A scene as structs of the C interface. The scene must outlive the view and keep its address.
class SceneView {
 public:
  explicit SceneView(const Scene&);
  SceneView(const SceneView&) = delete;
  SceneView& operator=(const SceneView&) = delete;
  const ClothbenchScene* scene() const { return &view_; }
  /// A frame's input; valid until the next call of `frame` or `restart`. Skins kinematic meshes; this is solver time.
  const ClothbenchFrame* frame(const FrameInput&);
  /// The state at the end of frame `last`; valid until the next call of `frame` or `restart` or a change of `state`.
  const ClothbenchRestart* restart(const ClothState& state, const FrameInput& last);

 private:
  /// Poses of all colliders at one instant, with the memory to which they point.
  struct Posed {
    std::vector<ClothbenchPose> poses;
    std::vector<std::vector<double>> vertices;  ///< of skinned meshes, one per collider
  };

  void add_colliders();
  void add_edges(EdgeKind, std::vector<ClothbenchEdge>&);
  void pose(const FrameMotion*, Posed&) const;
  const Posed& pose_before(const FrameInput&);
  void mark_teleports(const FrameInput&);

  const Scene& scene_;
  ClothbenchScene view_{};
  ClothbenchFrame frame_{};
  ClothbenchRestart restart_{};
  std::vector<double> position_, velocity_, mass_, rest_;
  std::vector<std::uint32_t> triangles_;
  std::vector<ClothbenchEdge> structural_, shear_, skip_;
  std::vector<ClothbenchCollider> colliders_;
  Posed start_, now_, before_;
  int posed_ = -1;  ///< index of the frame that `now_` is the end of; -1: none
  std::vector<std::uint8_t> collider_teleports_, grip_teleports_;
};

/// Values of the settings for the C interface, in the plugin's order.
std::vector<double> setting_values(const ClothbenchPlugin&, const nlohmann::json& settings);

/// Makes a solver of a plugin whose description has been checked.
std::unique_ptr<ClothSolver> make_solver(const ClothbenchPlugin&, const SolverInfo&, const nlohmann::json& settings);

}  // namespace clothbench::plugin
