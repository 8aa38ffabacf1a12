// Plane between two triangles of the cloth. It has the normal at the start and lies midway between their proposed
// positions, but within the gap at the start, so a vertex that does not move satisfies all these planes.
void select_self_plane(uint k) {
  if ((self_active[k].marks & SELF_PLANE) == 0u) return;
  uint own = self_active[k].own, other = self_active[k].other;
  uvec4 a = primitives[min(own, other)], b = primitives[max(own, other)];
  vec3 origin = starts[a.x].xyz, n = self_active[k].plane.xyz;
  float start_a = 1e30, end_a = 1e30, held_a = 1e30, start_b = -1e30, end_b = -1e30, held_b = -1e30;
  for (uint c = 0u; c < 3u; ++c) {
    vec4 at_a = y[a[c]], at_b = y[b[c]];
    float to_a = dot(n, at_a.xyz - origin), to_b = dot(n, at_b.xyz - origin);
    start_a = min(start_a, dot(n, starts[a[c]].xyz - origin));
    start_b = max(start_b, dot(n, starts[b[c]].xyz - origin));
    end_a = min(end_a, to_a);
    end_b = max(end_b, to_b);
    if (at_a.w == 0.0) held_a = min(held_a, to_a);
    if (at_b.w == 0.0) held_b = max(held_b, to_b);
  }
  float half_m = 0.5 * min(MIN_SEPARATION_M, start_a - start_b);
  float middle = clamp(0.5 * (end_a + end_b), start_b + half_m, start_a - half_m);
  // Attached vertices keep their prescribed positions, so the plane moves until they are on their side of it.
  middle = max(min(middle, held_a - half_m), held_b + half_m);
  float offset = middle + dot(n, origin);
  self_active[k].plane = own < other ? vec4(n, offset + half_m) : vec4(-n, half_m - offset);
}
