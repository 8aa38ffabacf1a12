#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "assets/hand_recording.hpp"
#include "clothbench/collider.hpp"

namespace clothbench {

/// Finds a file that a scene names: beside the scene `source`, else in the scenarios folder; empty if in neither.
std::optional<std::filesystem::path> file_of_scene(const std::string& name, const std::string& source);

/// A mesh for solvers; `closed` if it is the closed surface of a solid, with outward normals.
std::shared_ptr<ColliderMesh> collider_mesh(const assets::TriangleMesh&);
/// The collider mesh of a hand, which follows the hand's joints.
std::shared_ptr<ColliderMesh> collider_mesh(const assets::SkinnedMesh&);

/// The 19 capsules of a recorded hand; and the matrices by which the mesh of a hand follows its joints. A replay and
/// the live session that records it both use these functions, so they agree bit for bit.
ColliderPose capsules_pose(const assets::HandRecording&, const assets::RecordedHand&, const assets::Vector& offset_m);
ColliderPose mesh_pose(const assets::Hand&, const assets::JointFrames&, const assets::Vector& offset_m);

}  // namespace clothbench
