// One piece of the cloth and all that may touch it: calls meet() for every other piece in reach. Included by a kernel
// that has `starts`, `x`, `blocks` and `near`, after self.glsl, and defines void meet(bool edges) over what follows.

// Of the pair: the vertices, where they were at the substep's start and where they would be; X.w: inverse mass. A vertex
// and a triangle in this order, or own edge and other edge.
uvec4 who;
vec3 from[4], to[4];
vec4 inverse_mass;

void meet(bool edges);

void take(uint k, uint i) {
  who[k] = i;
  from[k] = LOAD16(starts, i).xyz;
}

void put(uint k, uint i, vec3 at) {
  who[k] = i;
  from[k] = at;
}

/// The rest, once the pair is near.
void take_ends() {
  for (uint k = 0u; k < 4u; ++k) {
    vec4 end = LOAD16(x, who[k]);
    to[k] = end.xyz;
    inverse_mass[k] = end.w;
  }
}

bool apart(vec3 low, vec3 high, vec3 other_low, vec3 other_high, float reach) {
  vec3 d = max(max(low - other_high, other_low - high), 0.0);
  return dot(d, d) > reach * reach;
}

#define KIND_VERTEX 0u    // against triangles
#define KIND_TRIANGLE 1u  // against vertices
#define KIND_EDGE 2u      // against edges; `later`: those with a higher number only

/// All pieces of the kind's other kind that begin with vertex j.
void meet_at(uint kind, uint own_number, uint j, vec3 low, vec3 high, float reach, bool later) {
  vec3 at = LOAD16(starts, j).xyz;
  if (kind == KIND_TRIANGLE) {
    if (j == who[1] || j == who[2] || j == who[3] || apart(low, high, at, at, reach)) return;
    put(0u, j, at);
    take_ends();
    meet(false);
    return;
  }
  bool right = j % p.columns + 1u < p.columns, down = j / p.columns + 1u < p.rows;
  if (kind == KIND_VERTEX && !(right && down)) return;
  uint b = j + (right ? 1u : 0u), d = j + (down ? p.columns : 0u), e = b + d - j;
  vec3 at_b = LOAD16(starts, b).xyz, at_d = LOAD16(starts, d).xyz, at_e = LOAD16(starts, e).xyz;
  if (apart(low, high, min(min(at, at_b), min(at_d, at_e)), max(max(at, at_b), max(at_d, at_e)), reach)) return;
  if (kind == KIND_VERTEX) {
    if (who[0] == j || who[0] == e) return;
    put(1u, j, at);
    if (who[0] != b && !apart(low, high, min(at, min(at_b, at_e)), max(at, max(at_b, at_e)), reach)) {
      put(2u, b, at_b);
      put(3u, e, at_e);
      take_ends();
      meet(false);
    }
    if (who[0] != d && !apart(low, high, min(at, min(at_d, at_e)), max(at, max(at_d, at_e)), reach)) {
      put(2u, e, at_e);
      put(3u, d, at_d);
      take_ends();
      meet(false);
    }
    return;
  }
  if (j == who[0] || j == who[1]) return;
  put(2u, j, at);
  for (uint family = 0u; family < 3u; ++family) {
    if ((family != 1u && !right) || (family != 0u && !down) || (later && 3u * j + family <= own_number)) continue;
    uint end = family == 0u ? b : family == 1u ? d : e;
    vec3 at_end = family == 0u ? at_b : family == 1u ? at_d : at_e;
    if (end == who[0] || end == who[1] || apart(low, high, min(at, at_end), max(at, at_end), reach)) continue;
    put(3u, end, at_end);
    take_ends();
    meet(true);
  }
}

/// `i`: the piece's first vertex, by whose block it is found. Its vertices are in who and from.
void meet_all(uint kind, uint own_number, uint i, vec3 low, vec3 high, bool later) {
  uint block = block_of(i);
  vec4 own_low = LOAD16(blocks, 3u * block), own_displacement = LOAD16(blocks, 3u * block + 2u);
  for (uint word = 0u; word < p.words; ++word)
    for (uint bits = LOAD4(near, block * p.words + word); bits != 0u; bits &= bits - 1u) {
      uint other = 32u * word + uint(findLSB(bits));
      float reach;
      if (!concern(low, high, own_displacement.xyz, own_low.w, LOAD16(blocks, 3u * other), LOAD16(blocks, 3u * other + 1u),
                   LOAD16(blocks, 3u * other + 2u), reach))
        continue;
      uvec3 all = vertices_of(other);
      for (uint k = 0u; k < all.y * all.z; ++k)
        meet_at(kind, own_number, all.x + k / all.y * p.columns + k % all.y, low, high, reach, later);
    }
}

/// Piece number `i` of a kind, edges and triangles of a family; false: there is none.
bool start_with(uint kind, uint family, uint i, out vec3 low, out vec3 high) {
  if (kind != KIND_VERTEX && !first_of(kind == KIND_TRIANGLE ? 2u : family, i)) return false;
  uint first = kind == KIND_TRIANGLE ? 1u : 0u, count = kind == KIND_VERTEX ? 1u : kind == KIND_TRIANGLE ? 3u : 2u;
  uvec3 corners = kind == KIND_TRIANGLE ? corners_of(family, i) : uvec3(i, kind == KIND_EDGE ? end_of(family, i) : i, i);
  for (uint k = 0u; k < count; ++k) take(first + k, corners[k]);
  low = high = from[first];
  for (uint k = first + 1u; k < first + count; ++k) {
    low = min(low, from[k]);
    high = max(high, from[k]);
  }
  return true;
}
