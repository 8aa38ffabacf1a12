// Nearest points of near pairs at the substep's start, and a contact there.

/// A triangle that stands is its own plane where that parts the pair: no nearest points are needed, and no contact but the
/// vertices'.
bool parted_by_face(uvec4 e, inout PairState s) {
  if (piece.count != 3u || piece.moves != 0u || piece.radius != 0.0 || e.w != 3u) return false;
  load_piece(t_begin);
  vec3 n = cross(piece_at[1] - piece_at[0], piece_at[2] - piece_at[0]);
  float l = length(n);
  if (!(l > 0.0)) return false;
  n /= l;
  vec3 start = vec3(0.0), end = vec3(0.0);
  [[unroll]] for (uint c = 0u; c < 3u; ++c) {
    start[c] = dot(n, cloth[c] - piece_at[0]);
    end[c] = dot(n, y[e[c]].xyz - around - piece_at[0]);
  }
  if (max(start.x, max(start.y, start.z)) < 0.0) {
    n = -n;
    start = -start;
    end = -end;
  }
  float gap = min(start.x, min(start.y, start.z));
  if (!(gap >= max(kGuard_m, kStandingShare * piece.margin) && min(end.x, min(end.y, end.z)) >= kGuard_m)) return false;
  s.normal = vec4(n, gap);
  return true;
}

uint look(uvec4 e, inout PairState s) {
  s.push = vec4(0.0);
  around = starts[e.x].xyz;
  [[unroll]] for (uint c = 0u; c < 3u; ++c) cloth[c] = starts[e[min(c, e.w - 1u)]].xyz - around;
  corners = e.w;
  if (parted_by_face(e, s)) return PAIR_LOOKED | PAIR_PLANE;
  Nearest r = nearest_at(t_begin, t_end, s.normal.xyz);
  if (!(r.gap > 0.0)) {
    if (turn == FIRST_TURN && writes_pair()) atomicAdd(faults.inside, 1u);
    s.normal.w = 0.0;
    return PAIR_LOOKED;
  }
  float gap = r.gap - piece.radius;
  s.normal = vec4(r.n, gap);
  // From the cloth's point and the gap, not from the piece's point: on a large face that has lost digits, and the share of a
  // substep's fall that they are would be missing from the normal force.
  vec3 on_cloth = r.on_cloth.x * cloth[0] + r.on_cloth.y * cloth[1] + r.on_cloth.z * cloth[2];
  s.weights = vec4(r.on_cloth, dot(r.n, on_cloth + r.way + around) - gap);
  s.way = vec4(r.way, min(kept_margin(e, s.weights.xyz), gap));
  return PAIR_LOOKED | PAIR_NEAREST | (e.w == 3u ? PAIR_PLANE : 0u);
}

/// Asks a pair that is near for its nearest points, unless that is done, and what its contact proposes.
void ask(uint k) {
  uvec4 pair = LOAD16(pairs, k);
  uvec4 e = LOAD16(elements, pair.x);
  PairState s = states[k];
  piece = pieces[pair.y];
  if ((pair.z & PAIR_NEAREST) == 0u) {
    pair.z = look(e, s);
    if (writes_pair()) pairs[k].z = pair.z;
  }
  s.push = (pair.z & PAIR_NEAREST) != 0u ? push_of(e, s) : vec4(0.0);
  if (!writes_pair()) return;
  mark_push(k, e, s.push != vec4(0.0), false);
  states[k] = s;
}
