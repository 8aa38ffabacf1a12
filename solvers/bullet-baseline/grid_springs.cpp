#include "bullet-baseline/grid_springs.hpp"

#include <BulletSoftBody/btSoftBody.h>

namespace clothbench::bullet_baseline {
namespace {

/// From the first end to the second, where Bullet evaluates forces.
btVector3 reach(const btSoftBody::Link& l) { return l.m_n[1]->m_q - l.m_n[0]->m_q; }

}  // namespace

void GridSprings::addScaledElasticForce(btScalar scale, TVStack& force) {
  for (int i = 0; i < body().m_links.size(); ++i) {
    const btSoftBody::Link& l = body().m_links[i];
    const btVector3 d = reach(l);
    const btScalar length = d.length();
    if (!(length > SIMD_EPSILON)) continue;  // no direction to push in
    const btVector3 pull = d * (scale * stiffness_[static_cast<std::size_t>(i)] * (1 - l.m_rl / length));
    force[l.m_n[0]->index] += pull;
    force[l.m_n[1]->index] -= pull;
  }
}

void GridSprings::addScaledElasticForceDifferential(btScalar scale, const TVStack& dx, TVStack& df) {
  for (int i = 0; i < body().m_links.size(); ++i) {
    const btSoftBody::Link& l = body().m_links[i];
    const btVector3 d = reach(l);
    const btScalar length = d.length();
    if (!(length > SIMD_EPSILON)) continue;
    // dF = k (n n^T + (1 - r/|d|) (1 - n n^T)) (dx_1 - dx_0)
    const btVector3 n = d / length, apart = dx[l.m_n[1]->index] - dx[l.m_n[0]->index];
    const btScalar along = n.dot(apart), slack = l.m_rl / length;
    const btVector3 change =
        (apart * (1 - slack) + n * (along * slack)) * (scale * stiffness_[static_cast<std::size_t>(i)]);
    df[l.m_n[0]->index] += change;
    df[l.m_n[1]->index] -= change;
  }
}

double GridSprings::totalElasticEnergy(btScalar) {
  double energy = 0;
  for (int i = 0; i < body().m_links.size(); ++i) {
    const btSoftBody::Link& l = body().m_links[i];
    const double longer = static_cast<double>(reach(l).length() - l.m_rl);
    energy += 0.5 * static_cast<double>(stiffness_[static_cast<std::size_t>(i)]) * longer * longer;
  }
  return energy;
}

}  // namespace clothbench::bullet_baseline
