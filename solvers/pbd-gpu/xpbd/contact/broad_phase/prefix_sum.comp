#version 450
// Start of a frame, one workgroup: the maximum fraction of the motion bounds whose pairs fit the list, and
// where each primitive's pairs begin. In: a primitive's pairs at each share; out: first, pairs. OF_SELF: the same
// for the list of self-contact pairs.
#include "xpbd/contact/contact_buffers.glsl"
const uint kThreads = 256u;
const uint kBlock = 32u;
shared uvec4 sums[kThreads];
shared uvec4 block_sums[1024u / kBlock];

void main() {
  uint t = gl_LocalInvocationIndex;
  uint n = OF_SELF ? TRIANGLES : TRIANGLES + VERTICES, capacity = OF_SELF ? SELF_CAPACITY : CAPACITY;
  uint each = (n + kThreads - 1u) / kThreads;
  uint begin = min(t * each, n), end = min(begin + each, n);
  uvec4 sum = uvec4(0u);
  for (uint k = begin; k < end; ++k) sum += ranges[k];
  sums[t] = sum;
  barrier();  // wait for the threads' sums before summing blocks of threads
  if (t % kBlock == 0u) {
    uvec4 of_block = uvec4(0u);
    for (uint k = 0u; k < kBlock; ++k) of_block += sums[t + k];
    block_sums[t / kBlock] = of_block;
  }
  barrier();  // sums of blocks before all read them
  uvec4 before = uvec4(0u), all = uvec4(0u);
  for (uint b = 0u; b < kThreads / kBlock; ++b) {
    if (b < t / kBlock) before += block_sums[b];
    all += block_sums[b];
  }
  for (uint k = t / kBlock * kBlock; k < t; ++k) before += sums[k];
  uint level = 0u;
  while (level + 1u < PAIR_LEVELS && all[level] > capacity) ++level;
  uint first = before[level];
  for (uint k = begin; k < end; ++k) {
    uint count = ranges[k][level], room = first < capacity ? capacity - first : 0u;
    ranges[k] = uvec4(min(first, capacity), min(count, room), 0u, 0u);
    first += count;
  }
  if (t > 0u) return;
  float fraction = kFractions[level];
  if (OF_SELF) {
    frame_state.self_bound_fraction = fraction;
  } else {
    frame_state.pairs = min(all[level], capacity);
    frame_state.bound_fraction = fraction;
  }
  if (all[level] > capacity) diagnostics.overflow += all[level] - capacity;
}
