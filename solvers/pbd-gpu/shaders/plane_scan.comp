#version 450
// Start of a frame, one workgroup: the greatest share of the reaches whose pairs the list has place for, and where each element's
// pairs begin.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(push_constant) uniform Push { PlaneContactConstants p; };
layout(std430, binding = BIND_RANGES) buffer Ranges { uvec4 ranges[]; };  // in: pairs at each share; out: first, pairs
layout(std430, binding = BIND_LEDGER) buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_FAULTS) buffer Faults { ContactFaults faults; };

const uint kThreads = 256u;
shared uvec4 sums[kThreads];

void main() {
  uint t = gl_LocalInvocationIndex, n = p.triangles + p.vertices, each = (n + kThreads - 1u) / kThreads;
  uint begin = min(t * each, n), end = min(begin + each, n);
  uvec4 sum = uvec4(0u);
  for (uint k = begin; k < end; ++k) sum += LOAD16(ranges, k);
  sums[t] = sum;
  barrier();
  // Each thread sums what is before it: few additions, and no rounds to wait for.
  uvec4 before = uvec4(0u), all = uvec4(0u);
  for (uint k = 0u; k < kThreads; ++k) {
    if (k < t) before += sums[k];
    all += sums[k];
  }
  uint level = 0u;
  while (level + 1u < PAIR_LEVELS && all[level] > p.capacity) ++level;
  uint first = before[level];
  for (uint k = begin; k < end; ++k) {
    uint count = ranges[k][level], room = first < p.capacity ? p.capacity - first : 0u;
    STORE16(ranges, k, uvec4(min(first, p.capacity), min(count, room), 0u, 0u));
    first += count;
  }
  if (t > 0u) return;
  ledger.pairs = min(all[level], p.capacity);
  ledger.reach = pow(0.5, float(level));
  if (all[level] > p.capacity) faults.dropped += all[level] - p.capacity;
}
