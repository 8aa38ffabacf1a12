// Corrections that the contacts of an active pair propose for the vertices of its own triangle; both sides move.
#include "xpbd/contact/response/friction.glsl"
SelfCorrection own_correction[3];

void propose_self(uint corner, float share, vec3 by, float depenetration, vec3 normal) {
  vec3 velocity_part = share * by, all = velocity_part + share * depenetration * normal;
  float l = length(all);
  own_correction[corner].all += vec4(l * all, l);
  own_correction[corner].velocity_part += vec4(l * velocity_part, 0.0);
}

/// `a`, `b`: vertices of the triangles of the lower and the higher number.
void correct_contact(SelfContact s, uvec4 a, uvec4 b, bool own_is_a) {
  vec3 origin = starts[a.x].xyz, apart = vec3(0.0), slip = vec3(0.0);
  vec3 w_a, w_b, first = vec3(s.weights.xy, 1.0 - s.weights.x - s.weights.y),
                 second = vec3(s.weights.zw, 1.0 - s.weights.z - s.weights.w);
  float mass = 0.0;
  for (uint c = 0u; c < 3u; ++c) {
    vec4 at_a = y[a[c]], at_b = y[b[c]];
    apart += first[c] * (at_a.xyz - origin) - second[c] * (at_b.xyz - origin);
    slip += first[c] * (at_a.xyz - starts[a[c]].xyz) - second[c] * (at_b.xyz - starts[b[c]].xyz);
    mass += at_a.w * first[c] * first[c] + at_b.w * second[c] * second[c];
    w_a[c] = at_a.w;
    w_b[c] = at_b.w;
  }
  if (!(mass > 0.0)) return;
  vec3 n = s.normal.xyz;
  Correction r = respond_along(n, s.normal.w - dot(n, apart), recovery(THICKNESS_M - s.normal.w, THICKNESS_M), slip,
                               SELF_FRICTION);
  for (uint c = 0u; c < 3u; ++c) {
    float share = own_is_a ? first[c] * w_a[c] : -second[c] * w_b[c];
    if (share != 0.0) propose_self(c, share / mass, r.velocity_part, r.depenetration, n);
  }
}

void correct_self(uint k) {
  uint own = self_active[k].own, other = self_active[k].other;
  uint count = uint(bitCount(self_active[k].marks & ~SELF_PLANE)), at = self_active[k].link;
  if (count == 0u) return;
  uint first = self_active[k].first_contact;
  for (uint c = 0u; c < 3u; ++c) own_correction[c] = SelfCorrection(vec4(0.0), vec4(0.0));
  uvec4 a = primitives[min(own, other)], b = primitives[max(own, other)];
  for (uint n = 0u; n < count; ++n) correct_contact(self_contacts[first + n], a, b, own < other);
  for (uint c = 0u; c < 3u; ++c) self_corrections[3u * at + c] = own_correction[c];
}
