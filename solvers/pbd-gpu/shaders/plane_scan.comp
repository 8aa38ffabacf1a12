#version 450
// Start of a frame, one workgroup.
#include "common.glsl"
#include "plane_buffers.glsl"
#ifdef SCAN_SELF
layout(std430, binding = BIND_SELF_RANGES) buffer SelfRanges { uvec4 self_ranges[]; };
#define SCAN_RANGES self_ranges
#define SCAN_COUNT TRIANGLES
#define SCAN_CAPACITY SELF_CAPACITY
#else
layout(std430, binding = BIND_RANGES) buffer Ranges { uvec4 ranges[]; };
#define SCAN_RANGES ranges
#define SCAN_COUNT (TRIANGLES + VERTICES)
#define SCAN_CAPACITY CAPACITY
#endif
layout(std430, binding = BIND_LEDGER) writeonly buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_FAULTS) buffer Faults { ContactFaults faults; };
const uint kThreads = 256u;
#include "plane_scan.glsl"

void main() { scan_ranges(gl_LocalInvocationIndex); }
