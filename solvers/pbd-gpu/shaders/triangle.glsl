// Nearest points of edges and triangles.

/// Weights of the point of edge ab nearest to q, and its squared distance.
vec3 on_edge(vec3 q, vec3 a, vec3 ab, out float squared) {
  float l = dot(ab, ab), t = l > 0.0 ? clamp(dot(q - a, ab) / l, 0.0, 1.0) : 0.0;
  vec3 d = q - a - t * ab;
  squared = dot(d, d);
  return vec3(1.0 - t, t, 0.0);
}

/// Barycentric weights of the point of triangle abc nearest to q. Triangles without area are their edges.
vec3 on_triangle(vec3 q, vec3 a, vec3 b, vec3 c) {
  vec3 ab = b - a, ac = c - a, aq = q - a, n = cross(ab, ac);
  float all = dot(n, n), wc = dot(cross(ab, aq), n), wb = dot(cross(aq, ac), n), wa = all - wb - wc;
  if (all > 0.0 && wa >= 0.0 && wb >= 0.0 && wc >= 0.0) return vec3(wa, wb, wc) / all;
  float best, second, third;
  vec3 w = on_edge(q, a, ab, best);
  vec3 on_bc = on_edge(q, b, c - b, second), on_ca = on_edge(q, c, a - c, third);
  if (second < best) {
    w = on_bc.zxy;
    best = second;
  }
  return third < best ? on_ca.yzx : w;
}
