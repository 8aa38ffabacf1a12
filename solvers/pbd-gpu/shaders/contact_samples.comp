#version 450
// Points on the edges of the cloth's triangles, along the grid and along one diagonal of each cell: without them an edge
// sinks into the corner of a table between two vertices that are outside. A sample is a point of its own that remembers
// its side as vertices do, follows its edge as far as contact lets it, and asks the two vertices for the
// rest. Edges are named by their first vertex: towards the next column, the next row, and both.
#define SAMPLE
#include "common.glsl"
layout(std430, binding = BIND_POSITIONS) readonly buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) readonly buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_SIDES) readonly buffer Sides { vec4 side[]; };
layout(std430, binding = BIND_CORRECTIONS) writeonly buffer Corrections { vec4 corrections[]; };
layout(std430, binding = BIND_SAMPLE_SIDES) buffer SampleSides { vec4 sample_side[]; };
layout(push_constant) uniform Push { ContactConstants p; };
#include "contact_colliders.glsl"
#include "contact_advance.glsl"

// A sample farther than this share of its edge from its place on it has lost it and starts anew from the vertex.
const float kLost = 0.5;

vec3 within(vec3 q, vec3 center, float radius) {
  vec3 d = q - center;
  return center + d * min(1.0, radius / max(length(d), 1e-30));
}

void main() {
  uint s = item() / LANES, n = p.columns * p.rows;
  if (s >= 3u * SAMPLES * n) return;
  uint family = s / (SAMPLES * n), i = s % n;
  float t = float(s / n % SAMPLES + 1u) / float(SAMPLES + 1u);
  bool right = family != 1u, down = family != 0u;
  if ((right && i % p.columns + 1u == p.columns) || (down && i / p.columns + 1u == p.rows)) return;
  uint j = i + (right ? 1u : 0u) + (down ? p.columns : 0u);
  vec4 a = LOAD16(x, i), b = LOAD16(x, j);
  if (a.w + b.w == 0.0) return;
  vec3 va = LOAD16(v, i).xyz, vb = LOAD16(v, j).xyz, side_a = LOAD16(side, i).xyz, side_b = LOAD16(side, j).xyz;
  vec3 place = mix(a.xyz, b.xyz, t), vel_before = mix(va, vb, t), vel = vel_before, to = place;
  vec4 was = LOAD16(sample_side, s);
  vec3 from = was.xyz;
  if (!(distance(from, mix(side_a, side_b, t)) < kLost * distance(side_a, side_b))) from = side_a;
#ifdef MESHES
  vec4 reach = LOAD16(reaches, i);
  from = distance(from, side_a) < p.sample_reach_m ? from : side_a;
  to = within(to, reach.xyz, reach.w + p.sample_reach_m);
#endif
  // Lists of clusters are a frame's, and so is what they say of how far away things are.
  float spare = p.begin > 0.0 && from == was.xyz ? was.w : 0.0;
  vec3 end = advance(from, to, i, dot(to, to) < kFar, vel, spare);
  if (lane() != 0u) return;
  // Both ends move as the point shall, or the free one by as much more as it is far: a sheet that comes down flat is not
  // deformed, as it would be if shares followed masses, which are halved on the border.
  float share = a.w == 0.0 ? 1.0 / t : b.w == 0.0 ? 1.0 / (1.0 - t) : 1.0;
  STORE16(corrections, 2u * s, vec4(end - place, touched ? share : 0.0));
  STORE16(corrections, 2u * s + 1u, vec4(vel - vel_before, 0.0));
  STORE16(sample_side, s, vec4(end, spare));
}
