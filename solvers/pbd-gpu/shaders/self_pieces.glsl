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

/// The rest, once the pair is near.
void take_ends() {
  for (uint k = 0u; k < 4u; ++k) {
    vec4 end = LOAD16(x, who[k]);
    to[k] = end.xyz;
    inverse_mass[k] = end.w;
  }
}

bool apart(vec3 low, vec3 high, uint first, uint count, float reach) {
  vec3 other_low = from[first], other_high = other_low;
  for (uint k = first + 1u; k < first + count; ++k) {
    other_low = min(other_low, from[k]);
    other_high = max(other_high, from[k]);
  }
  vec3 d = max(max(low - other_high, other_low - high), 0.0);
  return dot(d, d) > reach * reach;
}

#define KIND_VERTEX 0u    // against triangles
#define KIND_TRIANGLE 1u  // against vertices
#define KIND_EDGE 2u      // against edges; `later`: those with a higher number only

void meet_at(uint kind, uint own_number, uint j, vec3 low, vec3 high, float reach, bool later) {
  if (kind == KIND_TRIANGLE) {
    if (j == who[1] || j == who[2] || j == who[3]) return;
    take(0u, j);
    if (apart(low, high, 0u, 1u, reach)) return;
    take_ends();
    meet(false);
    return;
  }
  if (kind == KIND_VERTEX) {
    if (!first_of(2u, j)) return;
    for (uint half_cell = 0u; half_cell < 2u; ++half_cell) {
      uvec3 c = corners_of(half_cell, j);
      if (who[0] == c.x || who[0] == c.y || who[0] == c.z) continue;
      take(1u, c.x);
      take(2u, c.y);
      take(3u, c.z);
      if (apart(low, high, 1u, 3u, reach)) continue;
      take_ends();
      meet(false);
    }
    return;
  }
  for (uint family = 0u; family < 3u; ++family) {
    if (!first_of(family, j) || (later && 3u * j + family <= own_number)) continue;
    uint b = end_of(family, j);
    if (j == who[0] || j == who[1] || b == who[0] || b == who[1]) continue;
    take(2u, j);
    take(3u, b);
    if (apart(low, high, 2u, 2u, reach)) continue;
    take_ends();
    meet(true);
  }
}

/// `i`: the piece's first vertex, by whose block it is found. Its vertices are in who and from.
void meet_all(uint kind, uint own_number, uint i, vec3 low, vec3 high, bool later) {
  uint block = block_of(i);
  vec4 own_low = LOAD16(blocks, 3u * block), own_way = LOAD16(blocks, 3u * block + 2u);
  for (uint word = 0u; word < p.words; ++word)
    for (uint bits = LOAD4(near, block * p.words + word); bits != 0u; bits &= bits - 1u) {
      uint other = 32u * word + uint(findLSB(bits));
      float reach;
      if (!concern(low, high, own_way.xyz, own_low.w, LOAD16(blocks, 3u * other), LOAD16(blocks, 3u * other + 1u),
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
