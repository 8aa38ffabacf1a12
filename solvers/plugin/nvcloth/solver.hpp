/// A scene in NvCloth.
#pragma once

#include "nvcloth/colliders.hpp"
#include "nvcloth/fabric.hpp"

namespace clothbench::nvcloth {

/// The engine's settings in its own words; the order is that of `plugin.cpp`'s table.
struct Settings {
  double solver_frequency_hz, substeps, stiffness_frequency_hz, tethers, virtual_particles, continuous_collision,
      collision_margin_m, frictionless_triangles, cuda;
  explicit Settings(const double* values);
  /// Solver iterations in a frame of `dt` seconds: the engine rounds in the same way.
  int iterations(double dt_s) const;
  double frequency_hz(double frame_rate_hz) const;
};

/// Why the engine cannot run a scene; empty if it can.
std::string obstacle(const Settings&, const ClothbenchScene&);

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
  double margin_m(std::uint32_t collider) const;

  ClothbenchStage stage;

 private:
  void make_cloth(const double* position_m, const double* velocity_m_per_s);
  void drop_cloth();
  void set_constants();
  void add_virtual_particles();
  /// Positions [m] of the grips and whether each is held; null: where the scene starts, all of them.
  void hold(const double* position_m, const std::uint8_t* held);

  const ClothbenchScene& scene_;
  Settings settings_;
  peer::Point origin_;
  double iteration_s_;
  std::vector<double> inverse_mass_;  ///< [1/kg], 0 where pinned
  Colliders colliders_;
  nv::cloth::Factory* factory_ = nullptr;
  nv::cloth::Solver* solver_ = nullptr;
  nv::cloth::Cloth* cloth_ = nullptr;
  Cooked cooked_;
};

}  // namespace clothbench::nvcloth
