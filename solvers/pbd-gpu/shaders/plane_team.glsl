// Neighbouring lanes of a subgroup that share a vertex: TEAM of them, a power of two, or one thread
// where lanes cannot exchange values. All lanes of a subgroup come along: loops go on while any team needs them.
uint team_lane() { return gl_SubgroupInvocationID & (TEAM - 1u); }
float least_of_team(float value) {
  for (uint n = TEAM >> 1u; n > 0u; n >>= 1u) value = min(value, subgroupShuffleXor(value, n));
  return value;
}
uint most_of_subgroup(uint value) {
  for (uint n = gl_SubgroupSize >> 1u; n > 0u; n >>= 1u) value = max(value, subgroupShuffleXor(value, n));
  return value;
}
#define FROM_LANE(value, n) subgroupShuffle(value, (gl_SubgroupInvocationID & ~(TEAM - 1u)) + n)
