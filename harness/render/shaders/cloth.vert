#version 450
#include "../render_shared.h"
// Draws 6 vertices per cell of the grid, or 3 per triangle of a mesh, which pull their positions from the solver's own buffer (or one like it). There are no
// indices, so that every vertex knows its triangle and one with a corner that is not finite can be left out whole.
layout(push_constant) uniform Constants { Drawn d; };
layout(std430, set = 0, binding = 0) readonly buffer Positions { vec4 position[]; };
// For a mesh: 3 words per corner, its vertex and its position on the checker (bits of floats). Then for each vertex where its triangles begin,
// and the end of the last; then these triangles.
layout(std430, set = 0, binding = 3) readonly buffer Mesh { uint mesh[]; };
layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec2 out_square;
layout(location = 3) flat out int out_look;

// The two triangles of a cell, as clothbench::triangles(const Cloth&) has them.
const ivec2 kCorner[6] = ivec2[](ivec2(0, 0), ivec2(1, 0), ivec2(1, 1), ivec2(0, 0), ivec2(1, 1), ivec2(0, 1));
const float kFar = 1e18;  // further away counts as not finite; its square still is in float32

ivec2 grid() { return ivec2(d.sheet.xy); }

int vertex_of(ivec2 g) { return g.y * grid().x + g.x; }

vec3 at(ivec2 g) { return position[vertex_of(clamp(g, ivec2(0), grid() - 1))].xyz; }

bool finite(vec3 x) { return all(lessThan(abs(x), vec3(kFar))); }  // NaN fails

vec3 at_vertex(uint v) { return position[v].xyz; }

uint vertex_of(int triangle, int corner) { return mesh[9 * triangle + 3 * corner]; }

/// Mean normal of the triangles of a vertex, by area.
vec3 normal_of(uint v, int triangles, int vertices) {
  const int first = 9 * triangles + int(v), lists = 9 * triangles + vertices + 1;
  vec3 sum = vec3(0);
  for (uint k = mesh[first]; k < mesh[first + 1]; ++k) {
    const int t = int(mesh[lists + int(k)]);
    const vec3 a = at_vertex(vertex_of(t, 0)), n = cross(at_vertex(vertex_of(t, 1)) - a, at_vertex(vertex_of(t, 2)) - a);
    if (finite(n)) sum += n;
  }
  return sum / max(length(sum), 1e-30);
}

vec3 followed() {
  if (d.follow.w < 0) return vec3(0);
  const vec3 now = position[int(d.follow.w)].xyz;
  return finite(now) ? now - d.follow.xyz : vec3(0);
}

void draw_mesh() {
  const int triangle = gl_VertexIndex / 3, corner = gl_VertexIndex % 3, triangles = int(d.sheet.x);
  out_position = out_normal = vec3(0);
  out_square = vec2(0);
  out_look = LOOK_SMOOTH;
  for (int k = 0; k < 3; ++k)
    if (!finite(at_vertex(vertex_of(triangle, k)))) {
      gl_Position = vec4(0, 0, 2, 1);
      return;
    }
  const uint v = vertex_of(triangle, corner);
  const int word = 9 * triangle + 3 * corner;
  out_normal = normal_of(v, triangles, int(d.sheet.z));
  out_position = at_vertex(v) - followed() + d.origin.xyz;
  out_square = vec2(uintBitsToFloat(mesh[word + 1]), uintBitsToFloat(mesh[word + 2]));
  gl_Position = mat4(d.to_clip[0], d.to_clip[1], d.to_clip[2], d.to_clip[3]) * vec4(out_position, 1);
}

void main() {
  if (d.sheet.y == 0) {
    draw_mesh();
    return;
  }
  const ivec2 cells = grid() - 1;
  const int cell = gl_VertexIndex / 6, corner = gl_VertexIndex % 6;
  const ivec2 base = ivec2(cell % cells.x, cell / cells.x), g = base + kCorner[corner];
  out_position = out_normal = vec3(0);
  out_square = vec2(0);
  out_look = LOOK_SMOOTH;
  for (int k = corner / 3 * 3; k < corner / 3 * 3 + 3; ++k)
    if (!finite(at(base + kCorner[k]))) {
      gl_Position = vec4(0, 0, 2, 1);  // behind the far plane, as the other two
      return;
    }
  const vec3 du = at(g + ivec2(1, 0)) - at(g - ivec2(1, 0)), dv = at(g + ivec2(0, 1)) - at(g - ivec2(0, 1));
  const vec3 normal = cross(du, dv);
  if (finite(normal)) out_normal = normal / max(length(normal), 1e-30);
  out_position = at(g) - followed() + d.origin.xyz;
  out_square = vec2(g) / vec2(cells) * d.sheet.zw;
  gl_Position = mat4(d.to_clip[0], d.to_clip[1], d.to_clip[2], d.to_clip[3]) * vec4(out_position, 1);
}
