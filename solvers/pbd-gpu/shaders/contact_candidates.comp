#version 450
// Start of a frame: how far each vertex may go in it, and, a bit each, the clusters of triangles that it, or a sample on an
// edge that begins with it, can meet on its path. A bound that is kept (contact_vertices) and not a guess, and a list that
// cannot overflow. Before the words of a vertex' bits come blocks, a bit for each word that is not 0: of a whole room's hundreds
// of words few are looked at.
#include "common.glsl"
layout(std430, binding = BIND_POSITIONS) readonly buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) readonly buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_CLUSTERS) readonly buffer Clusters { MeshCluster clusters[]; };
layout(std430, binding = BIND_CLUSTER_BOXES) readonly buffer ClusterBoxes { ClusterBox cluster_boxes[]; };
layout(std430, binding = BIND_CANDIDATES) writeonly buffer Candidates { uint candidates[]; };
layout(std430, binding = BIND_REACHES) writeonly buffer Reaches { vec4 reaches[]; };
layout(push_constant) uniform Push { ContactConstants p; };
CONTACT_CONSTANTS(SPECIALIZE)
#include "lanes.glsl"

void main() {
  uint i = item() / LANES, n = p.columns * p.rows, blocks = (p.words + 31u) / 32u;
  if (i >= n) return;
  vec3 from = LOAD16(x, i).xyz;
  // A vertex may double its speed, and go as far as the fastest collider carries it.
  float carried = 0.0;
  for (uint k = lane(); k < MOVING_CLUSTERS; k += LANES)
    carried = max(carried, LOAD16(cluster_boxes, STANDING_CLUSTERS + k).low.w);
  carried = most_of_lanes(carried);
  if (i == 0u && lane() == 0u) STORE16(reaches, n, vec4(carried, 0.0, 0.0, 0.0));
  float reach = p.reach_m + 2.0 * length(LOAD16(v, i).xyz) / p.frames_per_s + carried;
  float nearest = 1e30;
  for (uint block = 0u; block < blocks; ++block) {
    uint words = 0u;
    for (uint word = 32u * block; word < min(32u * block + 32u, p.words); ++word) {
      uint bits = 0u;
      for (uint k = 32u * word + lane(); k < min(32u * word + 32u, STANDING_CLUSTERS + MOVING_CLUSTERS); k += LANES) {
        ClusterBox box = LOAD(32u, cluster_boxes, k);
        // Twice the margin: one to be held at, one for the push of the last substep, made after the displacement was cut to the reach.
        float margin = 2.0 * max(LOAD16(clusters, k).margin, max(p.least_margin_m, p.border_margin_m));
        vec3 apart = max(max(box.low.xyz - from, from - box.high.xyz), 0.0);
        float kept = p.sample_reach_m + margin + p.part * carried, range = reach + kept;
        if (dot(apart, apart) <= range * range) bits |= 1u << (k & 31u);
        nearest = min(nearest, length(apart) - kept);
      }
      bits = or_of_lanes(bits);
      if (bits != 0u) words |= 1u << (word & 31u);
      if (lane() == 0u) STORE4(candidates, (blocks + word) * n + i, bits);
    }
    if (lane() == 0u) STORE4(candidates, block * n + i, words);
  }
  nearest = least_of_lanes(nearest);
  // An empty list holds as far as the nearest cluster: no collider is nearer than that.
  if (lane() == 0u) STORE16(reaches, i, vec4(from, max(reach, nearest)));
}
