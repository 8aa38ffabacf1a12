// The lanes of a subgroup (at most 32) process a triangle together: each tests every lanes_per_triangle()-th candidate
// pair, triangle or group of triangles.
uint lanes_per_triangle() { return min(gl_SubgroupSize, 32u); }
uint triangle_lane() { return gl_SubgroupInvocationID; }
/// Bit mask of the lanes with `mine`.
uint ballot_bits(bool mine) { return subgroupBallot(mine).x; }
uint from_first_lane(uint value) { return subgroupBroadcastFirst(value); }

/// Runs BODY once per triangle `t`, in all lanes of the triangle's subgroup.
#define FOR_EACH_TRIANGLE(t, COUNT, BODY) \
  uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; \
  uint subgroups = gl_NumWorkGroups.x * gl_NumWorkGroups.y * gl_NumSubgroups; \
  for (uint t = group * gl_NumSubgroups + gl_SubgroupID; t < (COUNT); t += subgroups) BODY
