#version 450
// Boxes of the clusters of moving meshes, round their paths through the frame: corners move in straight lines.
#include "common.glsl"
layout(std430, binding = BIND_CLUSTERS) readonly buffer Clusters { MeshCluster clusters[]; };
layout(std430, binding = BIND_CLUSTER_BOXES) writeonly buffer ClusterBoxes { ClusterBox cluster_boxes[]; };
layout(std430, binding = BIND_TRIANGLES) readonly buffer Triangles { uvec4 triangles[]; };
layout(std430, binding = BIND_MOVING_START) readonly buffer MovingStart { vec4 moving_start[]; };
layout(std430, binding = BIND_MOVING_END) readonly buffer MovingEnd { vec4 moving_end[]; };
layout(push_constant) uniform Push { BoxConstants p; };

void main() {
  uint k = item();
  if (k >= p.count) return;
  MeshCluster cluster = LOAD16(clusters, p.first + k);
  vec3 low = vec3(1e30), high = vec3(-1e30);
  float displacement = 0.0;
  for (uint t = 0u; t < cluster.count; ++t) {
    uvec4 corners = LOAD16(triangles, cluster.first + t);
    for (int c = 0; c < 3; ++c) {
      vec3 start = LOAD16(moving_start, corners[c]).xyz, end = LOAD16(moving_end, corners[c]).xyz;
      low = min(low, min(start, end));
      high = max(high, max(start, end));
      displacement = max(displacement, distance(start, end));
    }
  }
  STORE32(cluster_boxes, p.first + k, ClusterBox(vec4(low, displacement), vec4(high, 0.0)));
}
