// Correction of a contact with a convex shape. Target gap: the smaller of the kept margin and the gap at the start.
#include "xpbd/contact/response/friction.glsl"

/// Margin that the target gap and the recovery use. With the whole margin, contacts of edges and faces would lift flat
/// cloth, so that its vertices no longer rest on a static shape.
float kept_margin(uvec4 e, vec3 weights) {
  bool inner = e.w == 3u && max(weights.x, max(weights.y, weights.z)) < 1.0 - kTiny;
  return shape.margin * (inner && shape.is_kinematic == 0u ? kStaticMarginFactor : 1.0);
}

/// The normal n and gap at the proposed position x of a contact point. With the start's normal, a point that moves past
/// an edge or corner would be pushed back. Shapes of more than three points: unchanged.
void turn_normal(vec3 x, inout vec3 n, inout float gap) {
  if (shape.count > 3u) return;
  vec3 q[3], d = vec3(0.0);
  [[unroll]] for (uint j = 0u; j < 3u; ++j) {
    ShapePoint at = points[shape.first + min(j, shape.count - 1u)];
    q[j] = (t_end == 1.0 ? at.end.xyz : at.start.xyz + t_end * (at.end.xyz - at.start.xyz)) - x;
  }
  float square = 1e30;
  [[unroll]] for (uint j = 0u; j < 3u; ++j) {
    vec3 f = q[(j + 1u) % 3u] - q[j];
    float ff = dot(f, f);
    vec3 from = -q[j] - (ff > 0.0 ? clamp(-dot(q[j], f) / ff, 0.0, 1.0) : 0.0) * f;
    if (dot(from, from) < square) {
      square = dot(from, from);
      d = from;
    }
  }
  vec3 face = cross(q[1] - q[0], q[2] - q[0]);
  bool on_face = shape.count == 3u && dot(cross(q[0], q[1]), face) >= 0.0 && dot(cross(q[1], q[2]), face) >= 0.0 &&
                 dot(cross(q[2], q[0]), face) >= 0.0;
  if (on_face) d = -dot(q[0], face) / dot(face, face) * face;
  float l = length(d);
  // A face's normal from the start is more accurate.
  if (!(dot(d, n) > 0.0) || (on_face && dot(d, n) > kSameNormal * l)) return;
  n = d / l;
  gap = l - shape.radius;
}

/// Correction of a contact, divided by the inverse mass of its point; w: depenetration. Input from the narrow phase:
/// weights.w = n·(shape's nearest point at the end), displacement_or_plane = (that point's displacement, target gap).
vec4 contact_correction(uvec4 e, PairState s) {
  if (response_round == 0u && shape.is_kinematic == 0u) return vec4(0.0);
  float gap = -s.weights.w, mass = 0.0;
  vec3 slip = -s.displacement_or_plane.xyz, n = s.normal.xyz, x = vec3(0.0);
  [[unroll]] for (uint c = 0u; c < 3u; ++c) {
    if (c >= e.w) continue;
    vec4 at = y[e[c]];
    float b = s.weights[c];
    gap += b * dot(n, at.xyz);
    x += b * at.xyz;
    slip += b * (at.xyz - starts[e[c]].xyz);
    mass += at.w * b * b;
  }
  if (!(mass > 0.0)) return vec4(0.0);
  float recover = recovery(kept_margin(e, s.weights.xyz) - s.displacement_or_plane.w, shape.margin);
  if (gap < s.displacement_or_plane.w) turn_normal(x, n, gap);
  Correction c = respond_along(n, s.displacement_or_plane.w - gap, recover, slip, shape.friction);
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
