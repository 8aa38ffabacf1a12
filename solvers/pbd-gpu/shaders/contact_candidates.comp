#version 450
// Start of a frame: how far each vertex may go in it, and, a bit each, the clusters of triangles that it, or a sample on an
// edge that begins with it, can meet on the way. A bound that is kept (contact_vertices) and not a guess, and a list that
// cannot overflow.
#define COUNTER_BINDING 6
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(std430, binding = 0) readonly buffer Positions { vec4 x[]; };
layout(std430, binding = 1) readonly buffer Velocities { vec4 v[]; };
layout(std430, binding = 2) readonly buffer Clusters { MeshCluster clusters[]; };
layout(std430, binding = 3) readonly buffer ClusterBoxes { ClusterBox cluster_boxes[]; };
layout(std430, binding = 4) writeonly buffer Candidates { uint candidates[]; };
layout(std430, binding = 5) writeonly buffer Reaches { vec4 reaches[]; };
layout(push_constant) uniform Push { ContactConstants p; };
layout(constant_id = 1) const uint STANDING_CLUSTERS = 0u;
layout(constant_id = 2) const uint MOVING_CLUSTERS = 0u;

void main() {
  uint i = item();
  if (i >= p.columns * p.rows) return;
  vec3 from = LOAD16(x, i).xyz;
  // A vertex may double its speed, and go as far as the fastest collider carries it.
  float carried = 0.0;
  for (uint k = 0u; k < MOVING_CLUSTERS; ++k)
    carried = max(carried, LOAD16(cluster_boxes, STANDING_CLUSTERS + k).low.w);
  float reach = p.reach_m + 2.0 * length(LOAD16(v, i).xyz) / p.frames_per_s + carried;
  float nearest = 1e30;
  for (uint word = 0u; word < p.words; ++word) {
    uint bits = 0u;
    for (uint k = 32u * word; k < min(32u * word + 32u, STANDING_CLUSTERS + MOVING_CLUSTERS); ++k) {
      ClusterBox box = LOAD(32u, cluster_boxes, k);
      // Twice the margin: one to be held at, one for the push of the last substep, made after the way was cut to reach.
      float margin = 2.0 * max(LOAD16(clusters, k).margin, max(p.least_margin_m, p.border_margin_m));
      vec3 apart = max(max(box.low.xyz - from, from - box.high.xyz), 0.0);
      float kept = p.sample_reach_m + margin + p.part * carried, range = reach + kept;
      if (dot(apart, apart) <= range * range) bits |= 1u << (k & 31u);
      nearest = min(nearest, length(apart) - kept);
    }
    STORE4(candidates, word * p.columns * p.rows + i, bits);
  }
  // An empty list holds as far as the nearest cluster: what is far away stops nobody.
  STORE16(reaches, i, vec4(from, max(reach, nearest)));
}
