// Correction of a contact with a convex shape. Target gap: the smaller of the kept margin and the gap at the start.
#include "xpbd/contact/response/friction.glsl"

/// Margin that the target gap and the recovery use. With the whole margin, contacts of edges and faces would lift flat
/// cloth, so that its vertices no longer rest on a static shape.
float kept_margin(uvec4 e, vec3 weights) {
  bool inner = e.w == 3u && max(weights.x, max(weights.y, weights.z)) < 1.0 - kTiny;
  return shape.margin * (inner && shape.is_kinematic == 0u ? kStaticMarginFactor : 1.0);
}

/// Correction of a contact, divided by the inverse mass of its point; w: depenetration. Input from the narrow phase:
/// weights.w = n·(shape's nearest point at the end), displacement_or_plane = (that point's displacement, target gap).
vec4 contact_correction(uvec4 e, PairState s) {
  if (response_round == 0u && shape.is_kinematic == 0u) return vec4(0.0);
  float gap = -s.weights.w, mass = 0.0;
  vec3 slip = -s.displacement_or_plane.xyz;
  [[unroll]] for (uint c = 0u; c < 3u; ++c) {
    if (c >= e.w) continue;
    vec4 at = y[e[c]];
    float b = s.weights[c];
    gap += b * dot(s.normal.xyz, at.xyz);
    slip += b * (at.xyz - starts[e[c]].xyz);
    mass += at.w * b * b;
  }
  if (!(mass > 0.0)) return vec4(0.0);
  float recover = recovery(kept_margin(e, s.weights.xyz) - s.displacement_or_plane.w, shape.margin);
  Correction c = respond_along(s.normal.xyz, s.displacement_or_plane.w - gap, recover, slip, shape.friction);
  return vec4(c.velocity_part, c.depenetration) / mass;
}

/// Marks a pair that proposes a correction, and its vertices: later passes read only these. `proposed`: it is marked.
void mark_correction(uint k, uvec4 e, bool proposes, bool proposed) {
  if (proposes) {
    [[unroll]] for (uint c = 0u; c < 3u; ++c) touched[CORRECTED(e[min(c, e.w - 1u)])] = 1u;
    if (!proposed) atomicOr(active_bits[CORRECTION_BITS + k / 32u], 1u << k % 32u);
  } else if (proposed) {
    atomicAnd(active_bits[CORRECTION_BITS + k / 32u], ~(1u << k % 32u));
  }
}

/// A later round of response: the correction of a pair's contact at its vertices' new positions.
void respond(uint k) {
  uvec4 pair = pairs[k];
  if ((pair.z & PAIR_NEAREST) == 0u) return;
  shape = shapes[pair.y];
  uvec4 e = primitives[pair.x];
  PairState s = states[k];
  vec4 correction = contact_correction(e, s);
  mark_correction(k, e, correction != vec4(0.0), s.correction != vec4(0.0));
  states[k].correction = correction;
}
