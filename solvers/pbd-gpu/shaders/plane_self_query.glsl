// Nearest points of two triangles of the cloth at a substep's start. Both copies of a pair compute the same, the triangle of the lower
// number first, so that their normals are opposite bit for bit.
vec3 first_at[3], second_at[3];

bool has_vertex(uvec4 e, uint v) { return e.x == v || e.y == v || e.z == v; }

/// A vertex and a triangle are the contact of one pair of the vertex' triangles: the first that has no vertex of the other.
bool owns(uint v, uint own, uvec4 other) {
  uint end = LOAD4(fans, v + 1u);
  for (uint f = LOAD4(fans, v); f < end; ++f) {
    uint t = LOAD4(fans, f) / 4u;
    uvec4 e = LOAD16(elements, t);
    if (!(has_vertex(other, e.x) || has_vertex(other, e.y) || has_vertex(other, e.z))) return t == own;
  }
  return false;
}

/// Gap along n, from the second to the first, of what nearest_feature() has looked at.
float feature_gap(vec3 n) {
  float low = 1e30, high = -1e30;
  for (uint c = 0u; c < corners; ++c) low = min(low, dot(n, cloth[c]));
  for (uint c = 0u; c < piece.count; ++c) high = max(high, dot(n, piece_at[c]));
  return low - high;
}

/// The nearest points of what is in `cloth` and `piece_at`; w: their gap.
vec4 best_normal(Feature f) {
  vec4 best = vec4(0.0, 0.0, 0.0, -1e30);
  float l = length(f.apart);
  if (l > 0.0) best = vec4(f.apart / l, feature_gap(f.apart / l));
  // Of what nearly touches the difference of the nearest points has lost its digits; across the features it has not.
  float across = length(f.normal);
  if (f.square < 1e-6 && across > 0.0) {
    vec3 n = (dot(f.normal, f.apart) < 0.0 ? -1.0 : 1.0) / across * f.normal;
    float gap = feature_gap(n);
    if (gap > best.w) best = vec4(n, gap);
  }
  return best;
}

void keep_contact(inout uint contacts, uint k, uint c, vec4 normal, vec3 first, vec3 second) {
  if (!(normal.w > 0.0)) return;
  contacts |= 1u << c;
  self_contacts[SELF_CONTACTS * k + c] =
      SelfContact(vec4(normal.xyz, min(THICKNESS_M, normal.w)), vec4(first, 0.0), vec4(second, 0.0));
}

void vertex_contacts(inout uint contacts, uint k, uint own, uvec4 e, uvec4 other, float reach, bool is_first) {
  corners = 1u;
  piece.count = 3u;
  for (uint c = 0u; c < 3u; ++c) piece_at[c] = is_first ? second_at[c] : first_at[c];
  for (uint c = 0u; c < 3u; ++c) {
    if (!owns(e[c], own, other)) continue;
    for (uint i = 0u; i < 3u; ++i) cloth[i] = is_first ? first_at[c] : second_at[c];
    Feature f = nearest_feature();
    if (!(f.square <= reach * reach)) continue;
    vec4 n = best_normal(f);
    vec3 one = vec3(0.0);
    one[c] = 1.0;
    if (is_first)
      keep_contact(contacts, k, 1u + c, n, one, f.on_piece);
    else
      keep_contact(contacts, k, 4u + c, vec4(-n.xyz, n.w), f.on_piece, one);
  }
}

void query_self(uint k) {
  uint first = min(self_near[k].own, self_near[k].other), second = max(self_near[k].own, self_near[k].other);
  uvec4 a = LOAD16(elements, first), b = LOAD16(elements, second);
  vec3 origin = starts[a.x].xyz;
  float most_a = 0.0, most_b = 0.0;
  for (uint c = 0u; c < 3u; ++c) {
    vec4 at_a = starts[a[c]], at_b = starts[b[c]];
    cloth[c] = first_at[c] = at_a.xyz - origin;
    piece_at[c] = second_at[c] = at_b.xyz - origin;
    most_a = max(most_a, at_a.w);
    most_b = max(most_b, at_b.w);
  }
  corners = 3u;
  piece.count = 3u;
  Feature f = nearest_feature();
  vec4 normal = best_normal(f);
  self_near[k].multipliers = vec4(0.0);
  self_near[k].plane = normal;
  self_pairs[self_near[k].pair].bound = max(normal.w, 0.0);
  uint contacts = 0u;
  if (normal.w > 0.0 && normal.w <= most_a + most_b) {
    keep_contact(contacts, k, 0u, normal, f.on_cloth, f.on_piece);
    vertex_contacts(contacts, k, first, a, b, most_a + most_b, true);
    vertex_contacts(contacts, k, second, b, a, most_a + most_b, false);
  } else if (!(normal.w > 0.0) && turn == 0u && self_near[k].own == first) {
    atomicAdd(faults.inside, 1u);
  }
  self_near[k].contacts = contacts;
}
