// Nearest points of a primitive and the hull of more than three points (Gilbert, Johnson & Keerthi 1988). A simplex in
// the Minkowski difference approaches the origin. Its corners are indexed by constants, so they stay in registers.
struct Corner {
  vec3 at;     // cloth[a] - point b of the convex shape
  uint a, b;
};
Corner simplex[4];
float weight_of[4];
uint simplex_size;

vec4 on_segment(vec3 a, vec3 b) {
  vec3 d = b - a;
  float all = dot(d, d), t = all > 0.0 ? clamp(-dot(a, d) / all, 0.0, 1.0) : 0.0;
  return vec4(1.0 - t, t, 0.0, 0.0);
}

/// Weights of the point of triangle abc nearest to the origin (Ericson 2005, 5.1.5).
vec3 on_face(vec3 a, vec3 b, vec3 c) {
  vec3 ab = b - a, ac = c - a;
  float d1 = -dot(ab, a), d2 = -dot(ac, a);
  if (d1 <= 0.0 && d2 <= 0.0) return vec3(1.0, 0.0, 0.0);
  float d3 = -dot(ab, b), d4 = -dot(ac, b);
  if (d3 >= 0.0 && d4 <= d3) return vec3(0.0, 1.0, 0.0);
  float vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return vec3(1.0 - d1 / (d1 - d3), d1 / (d1 - d3), 0.0);
  float d5 = -dot(ab, c), d6 = -dot(ac, c);
  if (d6 >= 0.0 && d5 <= d6) return vec3(0.0, 0.0, 1.0);
  float vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return vec3(1.0 - d2 / (d2 - d6), 0.0, d2 / (d2 - d6));
  float va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    float t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return vec3(0.0, 1.0 - t, t);
  }
  float all = va + vb + vc;
  if (!(all > 0.0)) return vec3(1.0, 0.0, 0.0);
  return vec3(1.0 - (vb + vc) / all, vb / all, vc / all);
}

/// Weights of the point nearest to the origin on the faces that have the origin outside. False if the origin is inside.
bool on_tetrahedron(out vec4 weights) {
  const uvec4 kFaces[4] =
      uvec4[4](uvec4(0u, 1u, 2u, 3u), uvec4(0u, 2u, 3u, 1u), uvec4(0u, 3u, 1u, 2u), uvec4(1u, 3u, 2u, 0u));
  const float kFlat = 1e-4;
  float best = 1e30;
  weights = vec4(0.0);
  [[unroll]] for (uint k = 0u; k < 4u; ++k) {
    const uvec4 f = kFaces[k];
    vec3 a = simplex[f.x].at, b = simplex[f.y].at, c = simplex[f.z].at, n = cross(b - a, c - a);
    float inner = dot(n, simplex[f.w].at - a), origin = -dot(n, a);
    // Skips a face with the origin on its inner side, unless rounding decides which side that is (flat tetrahedron).
    bool flat_one = abs(inner) <= kFlat * length(n) * length(simplex[f.w].at - a);
    if (!flat_one && origin * inner > 0.0) continue;
    vec3 l = on_face(a, b, c), q = l.x * a + l.y * b + l.z * c;
    float square = dot(q, q);
    if (!(square < best)) continue;
    best = square;
    weights = vec4(0.0);
    weights[f.x] = l.x;
    weights[f.y] = l.y;
    weights[f.z] = l.z;
  }
  return best < 1e30;
}

void put(uint slot, Corner c) {
  [[unroll]] for (uint m = 0u; m < 4u; ++m)
    if (m == slot) simplex[m] = c;
}

/// Finds the simplex point nearest to the origin and drops corners of weight 0. False: the origin is inside.
bool reduce() {
  vec4 weights = vec4(1.0, 0.0, 0.0, 0.0);
  if (simplex_size == 2u) weights = on_segment(simplex[0].at, simplex[1].at);
  if (simplex_size == 3u) weights = vec4(on_face(simplex[0].at, simplex[1].at, simplex[2].at), 0.0);
  if (simplex_size == 4u && !on_tetrahedron(weights)) return false;
  uint kept = 0u;
  [[unroll]] for (uint k = 0u; k < 4u; ++k) {
    if (!(k < simplex_size && weights[k] > 0.0)) continue;
    put(kept, simplex[k]);
    [[unroll]] for (uint m = 0u; m < 4u; ++m)
      if (m == kept) weight_of[m] = weights[k];
    ++kept;
  }
  simplex_size = kept;
  return true;
}

#ifdef FUSED_FRAME
/// Index of the shape's support point along v, the lowest if there are several. The subgroup's lanes divide the points.
uint support_of_subgroup(vec3 v, float t) {
  float high = -1e30;
  uint best = 0u;
  for (uint j = gl_SubgroupInvocationID; j < shape.count; j += gl_SubgroupSize) {
    float d = dot(v, point_at(j, t));
    if (d > high) {
      high = d;
      best = j;
    }
  }
  for (uint k = gl_SubgroupSize >> 1u; k > 0u; k >>= 1u) {
    float other = subgroupShuffleXor(high, k);
    uint of_other = subgroupShuffleXor(best, k);
    if (other > high || (other == high && of_other < best)) {
      high = other;
      best = of_other;
    }
  }
  return best;
}
#else
uint support_of_subgroup(vec3 v, float t) { return 0u; }
#endif

/// Support point of the Minkowski difference (cloth minus shape) in direction -v.
Corner support(vec3 v, float t) {
  Corner c = Corner(vec3(0.0), 0u, 0u);
  float low = 1e30, high = -1e30;
  vec3 b = vec3(0.0);
  vec3 a = vec3(0.0);
  [[unroll]] for (uint i = 0u; i < 3u; ++i) {
    float d = dot(v, cloth[i]);
    if (i < corners && d < low) {
      low = d;
      c.a = i;
      a = cloth[i];
    }
  }
  if (by_subgroup) {
    c.b = support_of_subgroup(v, t);
    c.at = a - point_at(c.b, t);
    return c;
  }
  for (uint first = 0u; first < shape.count; first += kPointUnroll)
    [[unroll]] for (uint k = 0u; k < kPointUnroll; ++k) {
      uint j = min(first + k, shape.count - 1u);
      vec3 at = point_at(j, t);
      float d = dot(v, at);
      if (d > high) {
        high = d;
        c.b = j;
        b = at;
      }
    }
  c.at = a - b;
  return c;
}

/// Tries the normal of the plane of three simplex corners: the difference of nearest points has lost digits, and a
/// tilt of 0.001 acts as friction.
void across_features(inout Nearest r, vec3 v, float t) {
  const float kSame = 5.0;  // [rounding errors] gaps that rounding cannot tell apart
  if (simplex_size != 3u) return;
  vec3 n = cross(simplex[1].at - simplex[0].at, simplex[2].at - simplex[0].at);
  float l = length(n);
  if (!(l > 0.0)) return;
  n *= (dot(n, v) < 0.0 ? -1.0 : 1.0) / l;
  float gap = gap_now(n, t);
  if (!(gap > r.gap - kSame * ROUNDING_M)) return;
  r.n = n;
  r.gap = gap;
}

Nearest nearest_of_hull(float begin, float end, vec3 guess) {
  const uint kMax = 32u;
  const float kClose = 3e-7;  // tolerance relative to the squared distance
  vec3 v = dot(guess, guess) > 0.0 ? guess : cloth[0] - point_at(0u, begin);
  if (dot(v, v) == 0.0) v = vec3(0.0, 1.0, 0.0);
  simplex_size = 0u;
  Nearest r = Nearest(vec3(0.0), -1e30, vec3(0.0), vec3(0.0), vec3(0.0));
  for (uint k = 0u; k < kMax; ++k) {
    Corner c = support(v, begin);
    bool old = false;
    [[unroll]] for (uint m = 0u; m < 4u; ++m)
      old = old || (m < simplex_size && simplex[m].a == c.a && simplex[m].b == c.b);
    float square = dot(v, v);
    if (k > 0u && (old || square - dot(v, c.at) <= kClose * square)) break;
    put(simplex_size++, c);
    if (!reduce()) {  // inside, or so nearly that rounding cannot tell
      simplex_size = 1u;
      weight_of[0] = 1.0;
      break;
    }
    vec3 to = vec3(0.0);
    [[unroll]] for (uint m = 0u; m < 4u; ++m)
      if (m < simplex_size) to += weight_of[m] * simplex[m].at;
    // No progress: rounding would make the iteration cycle.
    if (!(dot(to, to) > 0.25 * ROUNDING_M * ROUNDING_M && (k == 0u || dot(to, to) < square))) break;
    v = to;
    if (simplex_size == 4u) break;
  }
  try_normal(r, v, begin);
  across_features(r, v, begin);
  if (!(r.gap > 0.0) && corners == 3u) {  // nothing separates them yet: perhaps the cloth triangle's normal does
    vec3 n = cross(cloth[1] - cloth[0], cloth[2] - cloth[0]);
    try_normal(r, n, begin);
    try_normal(r, -n, begin);
  }
  [[unroll]] for (uint m = 0u; m < 4u; ++m) {
    if (m >= simplex_size) continue;
    [[unroll]] for (uint c = 0u; c < 3u; ++c)
      if (c == simplex[m].a) r.on_cloth[c] += weight_of[m];
    r.displacement += weight_of[m] * (point_at(simplex[m].b, end) - point_at(simplex[m].b, begin));
  }
  return r;
}
