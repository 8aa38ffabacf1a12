#pragma once
#include "gpu_solver.hpp"
#include "runner/frame_drawer.hpp"

namespace clothbench::render {

struct SolverPositions {
  const vulkan::Buffer* buffer;  ///< a vec4 a vertex, as SceneRenderer::use_positions takes it
  Vec3 origin_m;
};

/// What a loaded GPU solver copies to the host first when it is asked for its state. Throws Error where that is not so.
SolverPositions positions_of(const pbd_gpu::GpuSolver&);

/// Both eyes of a headset, `width` x `height` pixels each, one after the other in one submission. The vertex shader
/// reads a GPU solver's own buffer; of a CPU solver read_state's positions are uploaded. Either is within the clock, as
/// a display's wait is not: nothing is shown.
Rendering stereo_rendering(int width, int height);

}  // namespace clothbench::render
