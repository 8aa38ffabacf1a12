#version 450
// Start of a frame, one workgroup.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_RANGES) buffer Ranges { uvec4 ranges[]; };  // in: pairs at each share; out: first, pairs
layout(std430, binding = BIND_LEDGER) writeonly buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_FAULTS) buffer Faults { ContactFaults faults; };
const uint kThreads = 256u;
#include "plane_scan.glsl"

void main() { scan_ranges(gl_LocalInvocationIndex); }
