// A cluster is LANES_PER_VERTEX (a power of two) neighbouring lanes of a subgroup that process a vertex together.
// Control flow is subgroup-uniform: loops continue while any cluster of the subgroup needs them.
uint cluster_lane() { return gl_SubgroupInvocationID & (LANES_PER_VERTEX - 1u); }
float cluster_min(float value) {
  for (uint n = LANES_PER_VERTEX >> 1u; n > 0u; n >>= 1u) value = min(value, subgroupShuffleXor(value, n));
  return value;
}
float subgroup_max(float value) {
  for (uint n = gl_SubgroupSize >> 1u; n > 0u; n >>= 1u) value = max(value, subgroupShuffleXor(value, n));
  return value;
}
#define FROM_LANE(value, n) subgroupShuffle(value, (gl_SubgroupInvocationID & ~(LANES_PER_VERTEX - 1u)) + n)
