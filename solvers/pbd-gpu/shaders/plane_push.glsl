// What a contact with a piece proposes: its nearest point as far from the piece as it should be.
#include "friction.glsl"

/// Margin that the contact keeps. Edges and faces keep less from what stands: flat cloth would be lifted off its vertices.
float kept_margin(uvec4 e, vec3 weights) {
  bool inner = e.w == 3u && max(weights.x, max(weights.y, weights.z)) < 1.0 - kTiny;
  return piece.margin * (inner && piece.moves == 0u ? kStandingShare : 1.0);
}

/// Proposed correction of a contact over the inverse mass of its point; w: its part along the normal that is no velocity.
vec4 push_of(uvec4 e, PairState s) {
  if (turn == 0u && piece.moves == 0u) return vec4(0.0);
  float gap = -s.weights.w, mass = 0.0;
  vec3 slip = -s.way.xyz;
  [[unroll]] for (uint c = 0u; c < 3u; ++c) {
    if (c >= e.w) continue;
    vec4 at = y[e[c]];
    float b = s.weights[c];
    gap += b * dot(s.normal.xyz, at.xyz);
    slip += b * (at.xyz - starts[e[c]].xyz);
    mass += at.w * b * b;
  }
  if (!(mass > 0.0)) return vec4(0.0);
  float recover = recovery(kept_margin(e, s.weights.xyz) - s.way.w, piece.margin);
  Correction c = respond_along(s.normal.xyz, s.way.w - gap, recover, slip, piece.friction);
  return vec4(c.moving, c.out_by) / mass;
}

/// Marks a pair whose contact proposes something, and its vertices, so that others need not be read.
void mark_push(uint k, uvec4 e, bool proposes, bool proposed) {
  if (proposes) {
    [[unroll]] for (uint c = 0u; c < 3u; ++c) touched[PUSHED(e[min(c, e.w - 1u)])] = 1u;
    if (!proposed) atomicOr(near_bits[PUSH_BITS + k / 32u], 1u << k % 32u);
  } else if (proposed) {
    atomicAnd(near_bits[PUSH_BITS + k / 32u], ~(1u << k % 32u));
  }
}
