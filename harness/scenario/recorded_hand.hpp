#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "assets/hand_recording.hpp"
#include "clothbench/collider.hpp"

namespace clothbench {

/// A file that a scene names: beside the scene `source`, else in the scenarios folder; empty if it is in neither.
std::optional<std::filesystem::path> file_of_scene(const std::string& name, const std::string& source);

/// A mesh for solvers; `closed` if it has an inside.
std::shared_ptr<ColliderMesh> collider_mesh(const assets::TriangleMesh&);
/// The same of a hand, which follows its joints.
std::shared_ptr<ColliderMesh> collider_mesh(const assets::SkinnedMesh&);
std::shared_ptr<ColliderMesh> collider_mesh(const assets::RecordedMesh&);

/// The 19 capsules of a recorded hand, or the matrices of its joints. What a scene that replays a recording and a live
/// session that makes it go through, so that both give the same bits. A recording without a mesh of its own moves
/// `stand_in`.
ColliderPose capsules_pose(const assets::HandRecording&, const assets::RecordedHand&, const assets::Vector& offset_m);
ColliderPose mesh_pose(const assets::HandRecording&, const assets::RecordedHand&, const assets::Hand* stand_in,
                       const assets::Vector& offset_m);

/// A frame's matrix for a collider's joint.
Affine affine(const Eigen::Affine3d&);

}  // namespace clothbench
