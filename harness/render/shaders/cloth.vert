#version 450
#include "../render_shared.h"
// Draws the cloth's triangles, 3 vertices each. The shader reads positions from the solver's own buffer, or from a buffer
// of the same layout. The draw is not indexed, so that every vertex knows its triangle, and a triangle with a corner that
// is not finite can be omitted.
layout(push_constant) uniform Constants { Drawn d; };
layout(std430, set = 0, binding = 0) readonly buffer Positions { vec4 position[]; };
// 3 words per corner of a triangle: its vertex and its position on the checker (two floats). Then the triangles of each
// vertex in CSR form: the offsets (one per vertex and the end), then the triangles.
layout(std430, set = 0, binding = 3) readonly buffer Mesh { uint mesh[]; };
layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec2 out_square;
layout(location = 3) flat out int out_look;

const float kFar = 1e18;  // larger coordinates count as not finite; float32 can still represent its square

bool finite(vec3 x) { return all(lessThan(abs(x), vec3(kFar))); }  // NaN fails

uint vertex_of(int triangle, int corner) { return mesh[9 * triangle + 3 * corner]; }

vec3 corner_of(int triangle, int corner) { return position[vertex_of(triangle, corner)].xyz; }

/// Mean normal of a vertex's triangles, weighted by area.
vec3 normal_of(uint v, int triangles, int vertices) {
  const int first = 9 * triangles + int(v), lists = 9 * triangles + vertices + 1;
  vec3 sum = vec3(0);
  for (uint k = mesh[first]; k < mesh[first + 1]; ++k) {
    const int t = int(mesh[lists + int(k)]);
    const vec3 a = corner_of(t, 0), n = cross(corner_of(t, 1) - a, corner_of(t, 2) - a);
    if (finite(n)) sum += n;
  }
  return sum / max(length(sum), 1e-30);
}

void main() {
  const int triangle = gl_VertexIndex / 3, corner = gl_VertexIndex % 3;
  out_position = out_normal = vec3(0);
  out_square = vec2(0);
  out_look = LOOK_SMOOTH;
  for (int k = 0; k < 3; ++k)
    if (!finite(corner_of(triangle, k))) {
      gl_Position = vec4(0, 0, 2, 1);  // behind the far plane, like the triangle's other corners
      return;
    }
  const int word = 9 * triangle + 3 * corner;
  out_normal = normal_of(mesh[word], int(d.sheet.x), int(d.sheet.y));
  out_position = corner_of(triangle, corner) + d.origin.xyz;
  out_square = vec2(uintBitsToFloat(mesh[word + 1]), uintBitsToFloat(mesh[word + 2]));
  gl_Position = mat4(d.to_clip[0], d.to_clip[1], d.to_clip[2], d.to_clip[3]) * vec4(out_position, 1);
}
