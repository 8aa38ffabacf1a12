// Neighbouring threads that share the work of one item. With SHUFFLES they are LANES neighbours in a subgroup (a power of
// two, at most 16): they hold the same state, each looks at its share of what there is, and they agree by shuffles. Those
// must stand where a whole subgroup comes along: loops go on while ANY of it wants to.
#ifdef SHUFFLES
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_vote : require
#extension GL_KHR_shader_subgroup_shuffle : require
#define ANY(condition) subgroupAny(condition)
uint lane() { return gl_LocalInvocationIndex & (LANES - 1u); }
uint or_of_lanes(uint bits) {
  for (uint k = LANES >> 1u; k > 0u; k >>= 1u) bits |= subgroupShuffleXor(bits, k);
  return bits;
}
float least_of_lanes(float value) {
  for (uint k = LANES >> 1u; k > 0u; k >>= 1u) value = min(value, subgroupShuffleXor(value, k));
  return value;
}
float most_of_lanes(float value) {
  for (uint k = LANES >> 1u; k > 0u; k >>= 1u) value = max(value, subgroupShuffleXor(value, k));
  return value;
}
/// The first lane that has `value`, in the subgroup's numbering; 0 if none has (no number).
uint lane_with(float value, float own) {
  uint first = own == value ? gl_SubgroupInvocationID : 0xffffffffu;
  for (uint k = LANES >> 1u; k > 0u; k >>= 1u) first = min(first, subgroupShuffleXor(first, k));
  return first == 0xffffffffu ? 0u : first;
}
#else
#define ANY(condition) (condition)
uint lane() { return 0u; }
uint or_of_lanes(uint bits) { return bits; }
float least_of_lanes(float value) { return value; }
float most_of_lanes(float value) { return value; }
#endif

/// Every LANES-th bit of a word, from the lane's own on.
uint own_bits() { return (0xffffffffu / ((1u << LANES) - 1u)) << lane(); }
