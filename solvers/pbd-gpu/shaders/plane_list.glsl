// Pairs of an element and a piece whose boxes meet, the element's grown by its vertices' reaches. First they are counted for several
// shares of the reaches (the greatest one that the list has place for is taken), then written.
vec3 low, high;
void box_for(uvec4 e, float share) {
  low = vec3(1e30);
  high = vec3(-1e30);
  for (uint c = 0u; c < e.w; ++c) {
    vec4 r = LOAD16(reaches, e[c]);
    low = min(low, r.xyz - share * r.w);
    high = max(high, r.xyz + share * r.w);
  }
}
bool meets(PieceBox b) {
  return all(lessThanEqual(low, b.high.xyz)) && all(lessThanEqual(b.low.xyz, high));
}

#ifndef COUNT_ALONE
void fill_pairs_of(uint k) {
  uvec4 range = LOAD16(ranges, k);
  box_for(LOAD16(elements, k), ledger.reach);
  uint at = range.x, end = range.x + range.y;
  for (uint g = 0u; g < GROUPS && at < end; ++g) {
    if (!meets(LOAD(32u, boxes, PIECES + g))) continue;
    for (uint q = PIECES_A_GROUP * g; q < min(PIECES_A_GROUP * (g + 1u), PIECES) && at < end; ++q) {
      if (!meets(LOAD(32u, boxes, q))) continue;
      STORE16(pairs, at, uvec4(k, q, 0u, 0u));
      states[at].normal = vec4(0.0);
      states[at].push = vec4(0.0);
      ++at;
    }
  }
}

/// Lists the vertices that pairs of their own or of their triangles may move, in no fixed order, and marks them.
void list_touched(uint i) {
  uint pairs_of = LOAD16(ranges, TRIANGLES + i).y;
  for (uint f = LOAD4(fans, i), end = LOAD4(fans, i + 1u); f < end; ++f) pairs_of += LOAD16(ranges, LOAD4(fans, f) / 4u).y;
  STORE4(touched, OF_PAIRS(i), pairs_of);
  if (pairs_of == 0u) return;
  STORE4(touched, atomicAdd(ledger.touched_vertices, 1u), i);
  vec4 at = LOAD16(x, i);
  STORE16(x, i, vec4(at.xyz, at.w / (1.0 + LOAD16(v, i).w)));  // plane_project.glsl
}
#endif

#ifndef FILL_ALONE
void count_pairs_of(uint k) {
  uvec4 e = LOAD16(elements, k), n = uvec4(0u);
  vec3 lows[PAIR_LEVELS], highs[PAIR_LEVELS];
  float share = 1.0;
  for (uint l = 0u; l < PAIR_LEVELS; ++l, share /= float(1u << CUT_BITS)) {
    box_for(e, share);
    lows[l] = low;
    highs[l] = high;
  }
  for (uint g = 0u; g < GROUPS; ++g) {
    low = lows[0];
    high = highs[0];
    if (!meets(LOAD(32u, boxes, PIECES + g))) continue;
    for (uint q = PIECES_A_GROUP * g; q < min(PIECES_A_GROUP * (g + 1u), PIECES); ++q) {
      PieceBox box = LOAD(32u, boxes, q);
      for (uint l = 0u; l < PAIR_LEVELS; ++l) {
        low = lows[l];
        high = highs[l];
        if (!meets(box)) break;
        ++n[l];
      }
    }
  }
  STORE16(ranges, k, n);
}
#endif
