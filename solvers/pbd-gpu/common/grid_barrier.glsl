// A barrier over all workgroups of a dispatch. Vulkan does not guarantee that they run at once. A trial dispatch while
// loading (`p.passes` = 0) tests it, and waiting is bounded: a workgroup whose wait times out sets a flag for the host.
layout(std430, binding = BIND_BARRIER) coherent volatile buffer BarrierCounter { uint arrived, left; };
layout(std430, binding = BIND_TIMED_OUT) coherent volatile writeonly buffer TimedOut { uint timed_out; };
shared bool all_arrived;

/// Writes of all threads before the barrier are visible to all threads after it. False if a workgroup did not arrive
/// within `p.timeout_polls` polls. The writers' memoryBarrierBuffer() makes coherent writes visible to any later
/// coherent read of any invocation (GLSL 4.60, 8.17); readers need no such barrier, which would cost a tenth of the
/// frame.
bool grid_barrier() {
  memoryBarrierBuffer();
  barrier();  // wait for this workgroup's writes before thread 0 reports its arrival
  if (gl_LocalInvocationIndex == 0u) {
    uint groups = gl_NumWorkGroups.x * gl_NumWorkGroups.y, seen = atomicAdd(arrived, 1u) + 1u;
    uint all = (seen + groups - 1u) / groups * groups;
    // Success depends on the last value read, not on `looks`, because lavapipe ends every loop after 65535 rounds.
    for (uint looks = 0u; looks < p.timeout_polls && seen < all; ++looks) seen = arrived;
    all_arrived = seen >= all;
    if (!all_arrived) timed_out = 1u;
  }
  barrier();  // wait for the other workgroups' arrival before this workgroup reads
  return all_arrived;
}

/// The last workgroup that leaves resets the counters.
void leave_grid_barrier() {
  if (gl_LocalInvocationIndex != 0u) return;
  uint groups = gl_NumWorkGroups.x * gl_NumWorkGroups.y;
  if (atomicAdd(left, 1u) + 1u < groups) return;
  arrived = 0u;
  left = 0u;
}
