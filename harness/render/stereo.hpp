#pragma once
#include "runner/frame_drawer.hpp"

namespace clothbench::render {

/// Both eyes of a headset, `width` x `height` pixels each, one after the other in one submission. The vertex shader
/// reads a GPU solver's own buffer; of a CPU solver read_state's positions are uploaded. Either is within the clock, as
/// a display's wait is not: nothing is shown.
Rendering stereo_rendering(int width, int height);

}  // namespace clothbench::render
