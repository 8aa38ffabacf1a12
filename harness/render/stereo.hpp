#pragma once
#include "runner/solver_run.hpp"

namespace clothbench::render {

/// Draws both eyes of a headset, `width` x `height` pixels each, one after the other in one submission. For a GPU
/// solver the vertex shader reads the solver's buffer; for a CPU solver the positions of read_state are uploaded. Both
/// are part of the measured time. Waiting for a display is not, since nothing is displayed.
Rendering stereo_rendering(int width, int height);

}  // namespace clothbench::render
