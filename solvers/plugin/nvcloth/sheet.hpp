/// A connected part of the cloth in the engine, with its collisions and attachments.
#pragma once

#include "nvcloth/fabric.hpp"
#include "nvcloth/parts.hpp"

namespace clothbench::nvcloth {

constexpr float kFree = 1e7F;  // radius [cm] of a motion constraint that does not act

/// Takes states and frames of the whole cloth, and uses its part of them.
class Sheet {
 public:
  Sheet(Part&& part, double margin_m, std::shared_ptr<const Cooked> cooked)
      : part_(std::move(part)),
        inverse_mass_(peer::inverse_masses(part_.scene)),
        origin_(peer::centre(part_.scene)),
        colliders_(part_.scene, origin_, margin_m),
        cooked_(std::move(cooked)) {}
  ~Sheet() { NV_CLOTH_DELETE(cloth); }
  Sheet(const Sheet&) = delete;
  Sheet& operator=(const Sheet&) = delete;

  nv::cloth::Cloth* cloth = nullptr;

  const Part& part() const { return part_; }
  const std::shared_ptr<const Cooked>& cooked() const { return cooked_; }

  /// Makes the cloth anew, so that nothing of its past remains.
  void restart(const ClothbenchRestart& start, double iteration_s) {
    NV_CLOTH_DELETE(cloth);
    colliders_.put(start.poses);
    std::vector<PxVec4> now;
    for (std::uint32_t v = 0; v < inverse_mass_.size(); ++v) now.push_back(particle(v, start, 0));
    cloth = require(device().factory->createCloth(range(now), *cooked_->fabric), "Factory::createCloth");
    put(start, iteration_s);
    const ClothbenchScene& s = part_.scene;
    const Point g = kPerMetre * peer::point(s.gravity_m_per_s2, 0);
    const bool friction = peer::needs(s, CLOTHBENCH_FRICTION) && s.collider_count > 0;
    cloth->setStiffnessFrequency(static_cast<float>(1 / iteration_s));
    cloth->setGravity(PxVec3(static_cast<float>(g[0]), static_cast<float>(g[1]), static_cast<float>(g[2])));
    // The fraction of velocity that an iteration removes.
    cloth->setDamping(PxVec3(static_cast<float>(-std::expm1(-s.damping_per_s * iteration_s))));
    cloth->setPhaseConfig(range(cooked_->phases));
    cloth->setFriction(static_cast<float>(friction ? s.colliders[0].friction : 0));
    cloth->enableContinuousCollision(colliders_.has_spheres());
    colliders_.place(*cloth);
    if (colliders_.has_spheres()) add_virtual_particles();
  }

  /// Gives the cloth the positions and velocities of a state.
  void put(const ClothbenchRestart& start, double iteration_s) {
    const nv::cloth::MappedRange<PxVec4> now = cloth->getCurrentParticles(), before = cloth->getPreviousParticles();
    for (std::uint32_t v = 0; v < inverse_mass_.size(); ++v) {
      now[v] = particle(v, start, 0);
      before[v] = particle(v, start, inverse_mass_[v] > 0 ? iteration_s : 0);
    }
  }

  void move(const ClothbenchFrame& frame) {
    attach(frame.grip_position_m, frame.grip_held);
    if (frame.grip_teleports != nullptr) cloth->clearInterpolation();
    colliders_.move(*cloth, frame);
  }

  /// Attaches vertices by motion constraints of radius 0, which the engine interpolates over the frame's iterations.
  /// `position_m`, `held`: one entry per grip. If null, all grips hold their vertices at the initial positions.
  void attach(const double* position_m, const std::uint8_t* held) {
    if (part_.grips.empty()) return;
    const nv::cloth::Range<PxVec4> spheres = cloth->getMotionConstraints();
    std::fill(spheres.begin(), spheres.end(), PxVec4(0, 0, 0, kFree));
    for (std::size_t k = 0; k < part_.grips.size(); ++k) {
      const std::uint32_t grip = part_.grips[k], v = part_.gripped[k];
      if (held != nullptr && held[grip] == 0) continue;
      const Point at = position_m != nullptr ? peer::point(position_m, grip) : peer::point(part_.scene.position_m, v);
      spheres[v] = to_engine(at - origin_, 0);
    }
  }

  bool is_finite() const {
    const nv::cloth::MappedRange<const PxVec4> x = nv::cloth::readCurrentParticles(*cloth);
    return std::all_of(x.begin(), x.end(), [](const PxVec4& p) { return std::isfinite(p.x + p.y + p.z); });
  }

  void read(double* position_m, double* velocity_m_per_s, double iteration_s) const {
    const auto now = readCurrentParticles(*cloth), before = readPreviousParticles(*cloth);
    for (std::uint32_t v = 0; v < inverse_mass_.size(); ++v)
      for (unsigned k = 0; k < 3; ++k) {
        const double x = static_cast<double>(now[v][k]), last = static_cast<double>(before[v][k]);
        position_m[3 * part_.vertices[v] + k] = origin_[k] + x / kPerMetre;
        velocity_m_per_s[3 * part_.vertices[v] + k] = inverse_mass_[v] > 0 ? (x - last) / kPerMetre / iteration_s : 0;
      }
  }

 private:
  /// A vertex `earlier_s` before a state. The engine stores velocities as differences of positions.
  PxVec4 particle(std::uint32_t v, const ClothbenchRestart& at, double earlier_s) const {
    const std::uint32_t k = part_.vertices[v];
    const Point x = peer::point(at.position_m, k) - earlier_s * peer::point(at.velocity_m_per_s, k);
    return to_engine(x - origin_, inverse_mass_[v]);
  }

  /// Adds a particle at the middle of each triangle. The engine tests these only against spheres and capsules.
  void add_virtual_particles() {
    std::vector<std::array<std::uint32_t, 4>> particles;
    for (std::uint32_t t = 0; t < part_.scene.triangle_count; ++t) {
      const std::uint32_t* v = part_.scene.triangles + 3 * t;
      particles.push_back({v[0], v[1], v[2], 0});
    }
    const std::vector<PxVec3> weights = {PxVec3(1.0F / 3)};
    using Indices = const std::uint32_t[4];
    auto* first = reinterpret_cast<Indices*>(particles.data());
    cloth->setVirtualParticles(nv::cloth::Range<Indices>(first, first + particles.size()), range(weights));
  }

  Part part_;
  std::vector<double> inverse_mass_;  ///< [1/kg], 0 where pinned
  Point origin_;
  Colliders colliders_;
  std::shared_ptr<const Cooked> cooked_;
};

}  // namespace clothbench::nvcloth
