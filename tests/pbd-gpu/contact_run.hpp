#pragma once
#include <string>
#include <vector>

#include "gpu_fixture.hpp"

namespace clothbench::pbd_gpu {

/// What a run did, judged by the metrics at every frame; greatest values over all colliders.
struct ContactRun {
  double crossings = 0;                         ///< points that pass through something in one frame
  double contour_m = 0, settled_contour_m = 0;  ///< at any frame; in the last half second
  double depth_m = 0;                           ///< in closed colliders
  double stretch = 0, stretch_end = 0;          ///< greatest structural edge over its rest length, less 1
  double kinetic_end_J = 0;
  double drift_end_m_per_s = 0;  ///< greatest speed of a vertex over the last half second, by displacement
  bool finite = true;
  double step_s = 0;  ///< mean wall time of a frame
  ClothState end;
};

/// Runs `scene` to its end, or `frames` of it.
ContactRun run_contact(ClothSolver& solver, const Scene& scene, int frames = 0);

}  // namespace clothbench::pbd_gpu
