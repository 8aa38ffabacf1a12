#version 450
// End of a substep: every vertex goes from where it was at the substep's start as far towards where it now is as contact
// lets it, after taking its share of what the samples on its edges need. X.w = inverse mass, 0 where pinned or held.
#include "common.glsl"
layout(std430, binding = BIND_POSITIONS) buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_SIDES) buffer Sides { vec4 side[]; };  // where the vertex was at the substep's start; w: `spare`, contact_advance
layout(std430, binding = BIND_CORRECTIONS) readonly buffer Corrections { vec4 corrections[]; };  // two a sample: displacement, velocity
layout(push_constant) uniform Push { ContactConstants p; };
#include "contact_colliders.glsl"
#include "contact_advance.glsl"

vec3 sum_x, sum_v;
float weight_x, weight_v;

/// The samples of the edge that `first` names.
void gather(uint family, uint first) {
  for (uint k = 0u; k < SAMPLES; ++k) {
    uint s = (family * SAMPLES + k) * p.columns * p.rows + first;
    vec4 c = LOAD16(corrections, 2u * s);
    if (c.w == 0.0) continue;
    vec3 displacement = c.w * c.xyz, gain = c.w * LOAD16(corrections, 2u * s + 1u).xyz;
    float l = length(displacement), g = length(gain);
    sum_x += l * displacement;
    sum_v += g * gain;
    weight_x += l;
    weight_v += g;
  }
}

/// What the samples on the up to six edges of the vertex ask for, in a fixed order: the mean weighted by how much each
/// asks. Equal corrections give that correction, as on a plane, and one among many that are content is not outvoted, as on a corner.
void gather_samples(uint i) {
  uint column = i % p.columns, row = i / p.columns;
  bool right = column + 1u < p.columns, left_of = column > 0u, down = row + 1u < p.rows, up = row > 0u;
  if (right) gather(0u, i);
  if (left_of) gather(0u, i - 1u);
  if (down) gather(1u, i);
  if (up) gather(1u, i - p.columns);
  if (right && down) gather(2u, i);
  if (left_of && up) gather(2u, i - p.columns - 1u);
}

void main() {
  uint i = item() / LANES;
  if (i >= p.columns * p.rows) return;
  vec4 to = LOAD16(x, i);
  if (to.w == 0.0) {
    if (lane() == 0u) STORE16(side, i, to);
    return;
  }
  vec4 was = LOAD16(side, i);
  vec3 vel = LOAD16(v, i).xyz, from = was.xyz;
  sum_x = sum_v = vec3(0.0);
  weight_x = weight_v = 0.0;
  if (SAMPLES > 0u) gather_samples(i);
  if (weight_x > 0.0) to.xyz += sum_x / weight_x;
  if (weight_v > 0.0) vel += sum_v / weight_v;
#ifdef MESHES
  // The list of clusters holds for this displacement and no further.
  vec4 reach = LOAD16(reaches, i);
  vec3 displacement = to.xyz - reach.xyz;
  if (length(displacement) > reach.w) to.xyz = reach.xyz + displacement * (reach.w / length(displacement));
#endif
  // A vertex that is NaN stays NaN, so that the runner finds it.
  float spare = p.begin > 0.0 ? was.w : 0.0;
  to.xyz = advance(from, to.xyz, i, dot(to.xyz, to.xyz) < kFar, vel, spare);
  if (lane() != 0u) return;
  STORE16(x, i, to);
  STORE16(v, i, vec4(vel, 0.0));
  STORE16(side, i, vec4(to.xyz, spare));
}
