#include "assets/hand.hpp"

#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"

namespace clothbench::assets {

std::vector<double> skinned(const SkinnedMesh& mesh, const JointFrames& joints) {
  std::array<Eigen::Affine3d, kJointCount> matrices;
  for (std::size_t j = 0; j < kJointCount; ++j) matrices[j] = joints[j] * mesh.inverse_bind[j];
  std::vector<double> out(mesh.rest.positions.size());
  for (std::size_t v = 0; v < mesh.rest.vertex_count(); ++v) {
    const Vector x = mesh.rest.vertex(v);
    Vector sum = Vector::Zero();
    for (std::size_t k = 0; k < 4; ++k)
      if (mesh.weights[v][k] != 0) sum += mesh.weights[v][k] * (matrices[mesh.joints[v][k]] * x);
    Vector::Map(out.data() + 3 * v) = sum;
  }
  return out;
}

const HandPose& Hand::pose(const std::string& name) const {
  const auto found = poses.find(name);
  if (found != poses.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [n, unused] : poses) known.push_back(n);
  throw Error("hand: no pose " + in_quotes(name) + nearest_known(name, known));
}

}  // namespace clothbench::assets
