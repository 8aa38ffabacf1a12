// Jolt's soft bodies behind clothbench_plugin.h.
#include "jolt/solver.hpp"

namespace clothbench::jolt {
namespace {

/// The engine's integrator: v = (v + g h) (1 - c h), x += h v.
double free_fall_m(const double* values, double dt_s, double gravity, double velocity, double damping,
                   std::int32_t frames) {
  const Settings settings(values);
  const int n = settings.iterations * settings.collision_steps;
  const double h = dt_s / n, kept = std::max(0.0, 1 - damping * h);
  return peer::fallen_m(std::int64_t{frames} * n, h, velocity, [=](double v) { return kept * (v + h * gravity); });
}

const ClothbenchSetting kSettings[] = {
    {"iterations", "iterations a step (mNumIterations): steps in time with one pass over the constraints each", 5, 1},
    {"substeps", "collision steps a frame (the second argument of PhysicsSystem::Update)", 1, 1},
    {"attachments", "long-range attachments to the pins: 0 none, 1 by straight distance, 2 along the sheet", 1, 1},
    {"bend_type", "0 none, 1 distance, 2 dihedral, on scenes without bending too", 1, 1},
    {"bend_compliance", "m/N (dihedral: rad/(N m)); negative: by the scene's bending rigidity", 1e-2, 0},
    {"collision_margin_m", "radius of vertices; 0: the largest margin of the scene", 0, 0}};

}  // namespace
}  // namespace clothbench::jolt

extern "C" const ClothbenchPlugin* clothbench_plugin(void) {
  using namespace clothbench::jolt;
  static const ClothbenchPlugin plugin = clothbench::peer::plugin<Solver, Settings>(
      {"jolt", "Jolt Physics", "Jolt Physics' soft bodies on one CPU core (AVX2)", "1", free_fall_m}, kSettings);
  return &plugin;
}
