#version 450
// Before a substep's end, a thread a near pair.
#include "common.glsl"
#include "plane_buffers.glsl"
#include "plane_geometry.glsl"
#include "plane_choose.glsl"

void main() {
  begin_substep(p.first_substep);
  for (uint n = item(); n < ledger.asked[1]; n += stride()) choose(pairs[n].w);
}
