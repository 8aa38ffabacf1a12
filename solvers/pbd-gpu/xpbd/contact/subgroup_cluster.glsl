// Neighbouring lanes of a subgroup that share a vertex: LANES_PER_VERTEX of them, a power of two, or one thread
// where lanes cannot exchange values. Control flow is subgroup-uniform: loops go on while any cluster needs them.
uint cluster_lane() { return gl_SubgroupInvocationID & (LANES_PER_VERTEX - 1u); }
float cluster_min(float value) {
  for (uint n = LANES_PER_VERTEX >> 1u; n > 0u; n >>= 1u) value = min(value, subgroupShuffleXor(value, n));
  return value;
}
uint subgroup_max(uint value) {
  for (uint n = gl_SubgroupSize >> 1u; n > 0u; n >>= 1u) value = max(value, subgroupShuffleXor(value, n));
  return value;
}
#define FROM_LANE(value, n) subgroupShuffle(value, (gl_SubgroupInvocationID & ~(LANES_PER_VERTEX - 1u)) + n)
