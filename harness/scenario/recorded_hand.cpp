#include "scenario/recorded_hand.hpp"

#include "clothbench/error.hpp"
#include "scenario/load.hpp"
#include "scenario/vec3.hpp"

namespace clothbench {
std::optional<std::filesystem::path> file_of_scene(const std::string& name, const std::string& source) {
  std::error_code ec;
  const std::filesystem::path beside = std::filesystem::path(source).parent_path() / name;
  if (std::filesystem::is_regular_file(beside, ec)) return beside;
  const std::filesystem::path named = scenario_root() / name;
  if (std::filesystem::is_regular_file(named, ec)) return named;
  return std::nullopt;
}

std::shared_ptr<ColliderMesh> collider_mesh(const assets::TriangleMesh& from) {
  auto mesh = std::make_shared<ColliderMesh>();
  mesh->positions = from.positions;
  mesh->triangles = from.triangles;
  // The mesh of a room can be closed too, but its solid is outside: penetration depth has no meaning in it.
  mesh->closed = assets::topology(from).closed_manifold() && assets::signed_volume(from) > 0;
  return mesh;
}

std::shared_ptr<ColliderMesh> collider_mesh(const assets::SkinnedMesh& from) {
  auto mesh = collider_mesh(from.rest);
  mesh->joints = from.joints;
  for (const auto& w : from.weights)
    mesh->weights.push_back(
        {static_cast<float>(w[0]), static_cast<float>(w[1]), static_cast<float>(w[2]), static_cast<float>(w[3])});
  mesh->joint_count = assets::kJointCount;
  return mesh;
}

std::shared_ptr<ColliderMesh> collider_mesh(const assets::RecordedMesh& from) {
  assets::TriangleMesh rest;
  rest.positions.assign(from.positions_m.begin(), from.positions_m.end());
  rest.triangles = from.triangles;
  auto mesh = collider_mesh(rest);
  mesh->joints = from.joints;
  mesh->weights = from.weights;
  mesh->joint_count = assets::kRecordedJointCount;
  return mesh;
}

Affine affine(const Eigen::Affine3d& m) {
  Affine a;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      a[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = m.matrix()(row, column);
  return a;
}

ColliderPose capsules_pose(const assets::HandRecording& recording, const assets::RecordedHand& hand,
                           const assets::Vector& offset_m) {
  ColliderPose pose;
  for (const assets::Capsule& c : assets::capsules(recording, hand))
    pose.capsules.push_back({to_vec3(c.a + offset_m), to_vec3(c.b + offset_m), c.radius_m});
  return pose;
}

ColliderPose mesh_pose(const assets::HandRecording& recording, const assets::RecordedHand& hand,
                       const assets::Hand* stand_in, const assets::Vector& offset_m) {
  ColliderPose pose;
  const Eigen::Translation3d offset(offset_m);
  if (recording.mesh) {
    for (std::size_t k = 0; k < assets::kRecordedJointCount; ++k)
      pose.joints.push_back(affine(offset * Eigen::Affine3d(assets::frame_of(hand.joints[k]) *
                                                            assets::frame_of(recording.mesh->bind[k]).inverse())));
    return pose;
  }
  if (stand_in == nullptr) throw Error("hand recording: expected a mesh in it, or a hand model to use in its place");
  const assets::HandPose joints = assets::pose_of(hand);
  for (std::size_t k = 0; k < assets::kJointCount; ++k)
    pose.joints.push_back(affine(offset * (joints.joints[k] * stand_in->mesh.inverse_bind[k])));
  return pose;
}

}  // namespace clothbench
