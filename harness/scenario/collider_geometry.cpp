#include <algorithm>

#include "clothbench/error.hpp"
#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"
#include "scenario/collider_kinds.hpp"

namespace clothbench {

const std::vector<ColliderKind>& collider_kinds() {
  static const std::vector<ColliderKind> all = {plane_kind(), sphere_kind(), box_kind(), capsules_kind(), mesh_kind()};
  return all;
}

const ColliderKind& kind_of(const Collider& c) {
  for (const ColliderKind& kind : collider_kinds())
    if (kind.shape == c.shape) return kind;
  throw Error("collider " + c.name + ": no such shape");
}

Feature Collider::feature() const { return moves() ? kind_of(*this).moving : kind_of(*this).standing; }

std::vector<double> posed_positions(const ColliderMesh& mesh, const ColliderPose& pose) {
  if (!mesh.skinned()) return mesh.positions;
  if (pose.joints.size() != mesh.joint_count)
    throw Error("posed_positions: expected " + std::to_string(mesh.joint_count) + " joints; found " +
                std::to_string(pose.joints.size()));
  std::vector<double> out(mesh.positions.size(), 0);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    for (std::size_t k = 0; k < 4; ++k) {
      const double weight = static_cast<double>(mesh.weights[v][k]);
      if (weight == 0) continue;
      const Affine& m = pose.joints[mesh.joints[v][k]];
      for (std::size_t row = 0; row < 3; ++row) {
        double at = m[row][3];
        for (std::size_t c = 0; c < 3; ++c) at += m[row][c] * mesh.positions[3 * v + c];
        out[3 * v + row] += weight * at;
      }
    }
  return out;
}

const FrameMotion* Scene::motion_after(int index) const {
  if (motion.empty()) return nullptr;
  const auto last = static_cast<int>(motion.size()) - 1;
  return &motion[static_cast<std::size_t>(std::clamp(index + 1, 0, last))];
}

FeatureSet unsupported(const SolverInfo& info, FeatureSet needs) {
  FeatureSet missing = needs - (info.supports | info.ignores);
  for (const auto& [feature, beside] : info.only_with)
    if (needs.has(feature) && !needs.has(beside)) missing.add(feature);
  return missing;
}

std::string missing_features(const SolverInfo& info, FeatureSet needs) {
  std::string text;
  unsupported(info, needs).for_each([&](Feature f) {
    text += (text.empty() ? info.name + " has no " : ", ") + std::string(name_of(f));
  });
  return text;
}

}  // namespace clothbench
