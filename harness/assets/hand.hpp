#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "assets/hand_pose.hpp"
#include "assets/mesh.hpp"

namespace clothbench::assets {

/// A closed mesh that follows joints by linear blend skinning: x = sum_k w_k J_k B_k x_rest, with J the joint's frame
/// and B the inverse of its frame at rest.
struct SkinnedMesh {
  TriangleMesh rest;
  std::vector<std::array<std::uint8_t, 4>> joints;  ///< per vertex, indices into kJointNames
  std::vector<std::array<double, 4>> weights;       ///< per vertex, sum 1
  JointFrames bind;                                 ///< joint frames at rest
  std::array<Eigen::Affine3d, kJointCount> inverse_bind;
};

/// Positions [m], xyz interleaved, of the mesh's vertices for these joint frames.
std::vector<double> skinned(const SkinnedMesh&, const JointFrames&);

/// Reads the WebXR generic hand (binary glTF, one mesh, one primitive, one skin with the 25 WebXR joints). Merges
/// coincident vertices, which the file repeats along texture seams. Throws Error naming the file and what is wrong.
SkinnedMesh parse_hand_glb(const std::string& bytes, const std::string& source);

/// A hand: its mesh, and kPoseNames in the palm frame (`palm_frame`) for this side.
struct Hand {
  Side side = Side::Right;
  SkinnedMesh mesh;
  std::map<std::string, HandPose, std::less<>> poses;
  /// Throws Error naming the nearest known pose.
  const HandPose& pose(const std::string& name) const;
};

}  // namespace clothbench::assets
