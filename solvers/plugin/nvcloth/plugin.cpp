// NvCloth behind clothbench_plugin.h.
#include "nvcloth/solver.hpp"

namespace clothbench::nvcloth {
namespace {

/// The engine's integrator: v += (v e^(-c h) - v) + g h, x += h v.
double free_fall_m(const double* values, double dt_s, double gravity, double velocity, double damping,
                   std::int32_t frames) {
  const int n = Settings(values).iterations(dt_s);
  const double h = dt_s / n, kept = std::exp(-damping * h);
  return peer::fallen_m(std::int64_t{frames} * n, h, velocity, [=](double v) { return kept * v + h * gravity; });
}

const ClothbenchSetting kSettings[] = {
    {"solver_frequency_hz", "solver iterations a second (setSolverFrequency)", 300, 0},
    {"substeps", "solver iterations a frame, in place of the solver frequency; 0: by the frequency", 0, 1},
    {"stiffness_frequency_hz", "frequency at which stiffness and damping are stated; 0: that of the iterations", 0, 0},
    {"tethers", "1: geodesic tethers to the pins", 1, 1},
    {"virtual_particles", "1: one in each triangle, against spheres and capsules", 1, 1},
    {"continuous_collision", "1: against spheres and capsules", 1, 1},
    {"collision_margin_m", "distance at which colliders hold the cloth; 0: the scene's margins", 0, 0},
    {"frictionless_triangles", "1: run scenes whose meshes have friction, without it; 0: refuse them", 0, 1},
    {"cuda", "1: NvCloth on CUDA, not built", 0, 1}};

}  // namespace
}  // namespace clothbench::nvcloth

extern "C" const ClothbenchPlugin* clothbench_plugin(void) {
  using namespace clothbench::nvcloth;
  static const ClothbenchPlugin plugin = clothbench::peer::plugin<Solver, Settings>(
      {"nvcloth", "NvCloth", "NvCloth 1.1.6 on one CPU core (SSE2), in centimetres", "1", free_fall_m}, kSettings);
  return &plugin;
}
