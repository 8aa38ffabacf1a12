// Nearest points of two triangles of the cloth at a substep's start. A pair is stored once per triangle; both copies
// compute with the triangle of the lower number first, so their contacts are bit-identical.
vec3 first_at[3], second_at[3];

bool has_vertex(uvec4 e, uint v) { return e.x == v || e.y == v || e.z == v; }

/// Whether `own` is the first of v's triangles without a vertex of `other`; that one owns the contact of v and `other`.
bool owns(uint v, uint own, uvec4 other) {
  uint end = vertex_triangles[v + 1u];
  for (uint f = vertex_triangles[v]; f < end; ++f) {
    uint t = vertex_triangles[f] / 4u;
    uvec4 e = primitives[t];
    if (!(has_vertex(other, e.x) || has_vertex(other, e.y) || has_vertex(other, e.z))) return t == own;
  }
  return false;
}

/// Gap along n from `shape_points` to `cloth`, the inputs of nearest_feature().
float feature_gap(vec3 n) {
  float low = 1e30, high = -1e30;
  for (uint c = 0u; c < corners; ++c) low = min(low, dot(n, cloth[c]));
  for (uint c = 0u; c < shape.count; ++c) high = max(high, dot(n, shape_points[c]));
  return low - high;
}

/// Unit normal from `shape_points` to `cloth` with the largest gap; w: that gap.
vec4 best_normal(Feature f) {
  vec4 best = vec4(0.0, 0.0, 0.0, -1e30);
  float l = length(f.apart);
  if (l > 0.0) best = vec4(f.apart / l, feature_gap(f.apart / l));
  // If triangles nearly touch, the difference of their nearest points has lost digits; the features' normal has not.
  float across = length(f.normal);
  if (f.square < 25.0 * MIN_SEPARATION_M * MIN_SEPARATION_M && across > 0.0) {
    vec3 n = (dot(f.normal, f.apart) < 0.0 ? -1.0 : 1.0) / across * f.normal;
    float gap = feature_gap(n);
    if (gap > best.w) best = vec4(n, gap);
  }
  return best;
}

// Contacts found for a pair, until store_contacts() reserves their place in the buffer.
SelfContact found[SELF_CONTACTS];
uint contacts;

void keep_contact(uint c, vec4 normal, vec3 first, vec3 second) {
  if (!(normal.w > 0.0)) return;
  contacts |= 1u << c;
  found[c] = SelfContact(vec4(normal.xyz, min(THICKNESS_M, normal.w)), vec4(first.xy, second.xy));
}

void vertex_contacts(uint own, uvec4 e, uvec4 other, float bound, bool is_first) {
  corners = 1u;
  shape.count = 3u;
  for (uint c = 0u; c < 3u; ++c) shape_points[c] = is_first ? second_at[c] : first_at[c];
  for (uint c = 0u; c < 3u; ++c) {
    if (!owns(e[c], own, other)) continue;
    for (uint i = 0u; i < 3u; ++i) cloth[i] = is_first ? first_at[c] : second_at[c];
    Feature f = nearest_feature();
    if (!(f.square <= bound * bound)) continue;
    vec4 n = best_normal(f);
    vec3 one = vec3(0.0);
    one[c] = 1.0;
    if (is_first)
      keep_contact(1u + c, n, one, f.on_shape);
    else
      keep_contact(4u + c, vec4(-n.xyz, n.w), f.on_shape, one);
  }
}

/// Upper bound of the approach of two triangles on the way to their proposed positions [m].
float approach(uvec4 a, uvec4 b, vec3 origin) {
  vec3 way_a[3], way_b[3], middle_a = vec3(0.0), middle_b = vec3(0.0);
  for (uint c = 0u; c < 3u; ++c) {
    way_a[c] = y[a[c]].xyz - origin - first_at[c];
    way_b[c] = y[b[c]].xyz - origin - second_at[c];
    middle_a += way_a[c] / 3.0;
    middle_b += way_b[c] / 3.0;
  }
  float around_a = 0.0, around_b = 0.0;
  for (uint c = 0u; c < 3u; ++c) {
    around_a = max(around_a, distance(way_a[c], middle_a));
    around_b = max(around_b, distance(way_b[c], middle_b));
  }
  return distance(middle_a, middle_b) + around_a + around_b;
}

/// Stores the contacts found. Their order in the buffer is not fixed, and nothing depends on it.
void store_contacts(uint k) {
  uint at = atomicAdd(frame_state.self_contact_pairs, 1u), count = uint(bitCount(contacts));
  uint to = atomicAdd(frame_state.self_contacts, count);
  if (at >= CONTACT_CAPACITY || to + count > CONTACTS_PER_PAIR * CONTACT_CAPACITY) {
    atomicAdd(diagnostics.overflow, 1u);
    contacts = 0u;
    return;
  }
  self_active[k].link = at;
  self_active[k].first_contact = to;
  for (uint c = 0u; c < SELF_CONTACTS; ++c)
    if ((contacts & (1u << c)) != 0u) self_contacts[to++] = found[c];
}

void query_self(uint k) {
  uint first = min(self_active[k].own, self_active[k].other), second = max(self_active[k].own, self_active[k].other);
  uvec4 a = primitives[first], b = primitives[second];
  vec3 origin = starts[a.x].xyz;
  float max_a = 0.0, max_b = 0.0;
  for (uint c = 0u; c < 3u; ++c) {
    vec4 at_a = starts[a[c]], at_b = starts[b[c]];
    cloth[c] = first_at[c] = at_a.xyz - origin;
    shape_points[c] = second_at[c] = at_b.xyz - origin;
    max_a = max(max_a, at_a.w);
    max_b = max(max_b, at_b.w);
  }
  corners = 3u;
  shape.count = 3u;
  Feature f = nearest_feature();
  vec4 normal = best_normal(f);
  for (uint c = 0u; c < 3u; ++c) self_active[k].multipliers[c] = 0.0;
  self_active[k].plane = normal;
  self_pairs[self_active[k].link].bound = max(normal.w, 0.0);
  contacts = 0u;
  bool separated = normal.w > 0.0 && normal.w <= max_a + max_b;
  float bound = approach(a, b, origin) + THICKNESS_M;
  if (separated && normal.w <= bound) {
    keep_contact(0u, normal, f.on_cloth, f.on_shape);
    vertex_contacts(first, a, b, bound, true);
    vertex_contacts(second, b, a, bound, false);
    store_contacts(k);
  }
  if (!(normal.w > 0.0) && self_active[k].own == first) atomicAdd(diagnostics.inside, 1u);
  self_active[k].marks = contacts | (separated ? SELF_PLANE : 0u);
}
