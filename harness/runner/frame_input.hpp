#pragma once
#include "clothbench/solver.hpp"

namespace clothbench {

/// What changes in frame `index` of the scene (0 = the first). Everything that steps a solver through a scene's frames
/// takes them from here, so that a hitch or a jitter of the scene's clock reaches the solver wherever the scene is run.
/// Past the scene's end, where timed trials may go on, frames are even and nothing moves.
FrameInput frame_input(const Scene& scene, int index);

}  // namespace clothbench
