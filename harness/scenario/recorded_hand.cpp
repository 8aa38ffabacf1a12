#include "scenario/recorded_hand.hpp"

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
  mesh->closed = assets::is_closed_manifold(from) && assets::signed_volume(from) > 0;
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

namespace {

/// The transform of a joint in the form of ColliderPose.
Affine affine(const Eigen::Affine3d& m) {
  Affine a;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      a[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = m.matrix()(row, column);
  return a;
}

}  // namespace

ColliderPose capsules_pose(const assets::HandRecording& recording, const assets::RecordedHand& hand,
                           const assets::Vector& offset_m) {
  ColliderPose pose;
  for (const assets::Capsule& c : assets::capsules(recording, hand))
    pose.capsules.push_back({to_vec3(c.a + offset_m), to_vec3(c.b + offset_m), c.radius_m});
  return pose;
}

ColliderPose mesh_pose(const assets::Hand& hand, const assets::JointFrames& joints, const assets::Vector& offset_m) {
  ColliderPose pose;
  for (std::size_t k = 0; k < assets::kJointCount; ++k)
    pose.joints.push_back(affine(Eigen::Translation3d(offset_m) * (joints[k] * hand.mesh.inverse_bind[k])));
  return pose;
}

}  // namespace clothbench
