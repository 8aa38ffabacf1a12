/// A scene in Jolt.
#pragma once

#include <memory>

#include "jolt/colliders.hpp"
#include "jolt/soft_body.hpp"

namespace clothbench::jolt {

/// The engine's settings in its own words; the order is that of `plugin.cpp`'s table.
struct Settings {
  int iterations, collision_steps;
  Attachments attachments;
  Bending bending;
  double collision_margin_m;
  explicit Settings(const double* values);
};

/// Why the engine cannot run a scene; empty if it can.
std::string obstacle(const Settings&, const ClothbenchScene&);

struct World;

class Solver {
 public:
  /// Throws std::runtime_error with the reason if the engine cannot run the scene.
  Solver(const Settings&, const ClothbenchScene&);
  ~Solver();
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  void reset();
  void restart(const ClothbenchRestart&);
  std::int32_t step(const ClothbenchFrame&);
  void read(double* position_m, double* velocity_m_per_s) const;
  /// The engine has one radius for all vertices: the largest margin of the scene, whichever the collider.
  double margin_m(std::uint32_t collider = 0) const;

  ClothbenchStage stage;

 private:
  void make_world(const double* position_m, const double* velocity_m_per_s, const ClothbenchPose*);
  void hold(const ClothbenchFrame&);

  const ClothbenchScene& scene_;
  Settings settings_;
  peer::Point origin_;
  JPH::Ref<JPH::SoftBodySharedSettings> shared_;
  Colliders colliders_;
  std::unique_ptr<World> world_;
};

}  // namespace clothbench::jolt
