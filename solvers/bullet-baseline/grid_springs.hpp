#pragma once
#include <BulletSoftBody/btDeformableMassSpringForce.h>

#include <vector>

namespace clothbench::bullet_baseline {

/// btDeformableMassSpringForce with a stiffness for each link. Bullet's has two in all. An isotropic grid needs one
/// along each direction, half of each on the borders, one on the diagonals and one for bending.
///
/// The energy is Bullet's, k/2 (|d| - r)^2. Its second derivative is exact, so it is indefinite where a link is
/// compressed. These springs do not damp: Bullet's spring damping is relative to neighbours, the scenes' damping is not.
class GridSprings final : public btDeformableMassSpringForce {
 public:
  /// Stiffness of each link of the one body it will be given [N/m, in Bullet's units].
  explicit GridSprings(std::vector<btScalar> stiffness) : stiffness_(std::move(stiffness)) {}

  void addScaledElasticForce(btScalar scale, TVStack& force) override;
  void addScaledElasticForceDifferential(btScalar scale, const TVStack& dx, TVStack& df) override;
  double totalElasticEnergy(btScalar dt) override;
  void addScaledDampingForce(btScalar, TVStack&) override {}
  void addScaledDampingForceDifferential(btScalar, const TVStack&, TVStack&) override {}
  void buildDampingForceDifferentialDiagonal(btScalar, TVStack&) override {}

 private:
  const btSoftBody& body() { return *m_softBodies[0]; }

  const std::vector<btScalar> stiffness_;
};

}  // namespace clothbench::bullet_baseline
