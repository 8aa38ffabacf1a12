// Each workgroup tests its part of the candidate pairs, kRounds per thread at a time. After each test the remaining
// pairs are distributed over the workgroup's threads again, so that no thread idles while its neighbour tests.
const uint kRounds = gl_WorkGroupSize.x < 512u ? 512u / gl_WorkGroupSize.x : 1u, kTested = kRounds * gl_WorkGroupSize.x;
// Barrier within a workgroup that also makes buffer writes visible.
#define WORKGROUP_BARRIER { groupMemoryBarrier(); barrier(); }
shared uint tested[kTested], active_found[kTested], tested_count, found_count, slot;
/// `first`: the number of this workgroup's first thread among the `at_once` threads of all workgroups.
void find_active_pairs(uint first, uint at_once) {
  uint thread = gl_LocalInvocationIndex;
  uint count = frame_state.pairs;  // read once, because a coherent read goes to the second-level cache
  for (uint base = first; base < count; base += kRounds * at_once) {
    if (thread == 0u) tested_count = found_count = 0u;
    barrier();  // wait for counts of 0 before threads add to them
    for (uint r = 0u; r < kRounds; ++r) {
      uint k = base + r * at_once + thread;
      if (k < count && may_be_active(k)) tested[atomicAdd(tested_count, 1u)] = k;
    }
    WORKGROUP_BARRIER;  // wait for tested pairs and their bounds before threads read them
    for (uint n = thread; n < tested_count; n += gl_WorkGroupSize.x)
      if (is_active(tested[n])) active_found[atomicAdd(found_count, 1u)] = tested[n];
    WORKGROUP_BARRIER;  // wait for active pairs and their normals before threads read them
    if (thread == 0u && found_count > 0u) slot = atomicAdd(ACTIVE_COUNT, found_count);
    barrier();  // wait for the slot before threads fill it
    for (uint n = thread; n < found_count; n += gl_WorkGroupSize.x) {
      append_active(active_found[n], slot + n);
      if (!kPairsOfSubgroups) process_pair(active_found[n]);
    }
    barrier();  // wait for all reads before thread 0 resets the counts
  }
}
