#version 450
#include "../render_shared.h"
layout(push_constant) uniform Constants { Drawn d; };
// Two vec4 per vertex: position from the picture's origin [m] and look; normal, unit.
layout(std430, set = 0, binding = 1) readonly buffer Vertices { vec4 vertex[]; };
layout(std430, set = 0, binding = 2) readonly buffer Corners { uint corner[]; };
layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec2 out_square;
layout(location = 3) flat out int out_look;

void main() {
  const uint v = corner[gl_VertexIndex];
  out_position = vertex[2 * v].xyz;
  out_look = int(vertex[2 * v].w);
  out_normal = vertex[2 * v + 1].xyz;
  out_square = vec2(0);
  gl_Position = mat4(d.to_clip[0], d.to_clip[1], d.to_clip[2], d.to_clip[3]) * vec4(out_position, 1);
}
