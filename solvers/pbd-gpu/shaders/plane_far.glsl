// A frame in which the cloth cannot meet a collider: as far as it may go there is no piece. It needs neither pairs nor planes, and has the
// motion of a cloth without colliders, bit for bit. Should the cloth go farther all the same, nothing is stored, and the frame is begun
// anew with contact.
const uint kMostNearGroups = 32u;  // of pieces; where more are near, some meet the cloth
shared uint near_groups[kMostNearGroups], near_group_count, farthest;
vec3 box_low, box_high;
float rest, by_hands;

/// How far a vertex may go, in .w of where it is.
vec4 freely(uint i) {
  vec4 at = LOAD16(x, i);
  return vec4(at.xyz, free_reach_at(length(LOAD16(v, i).xyz), rest, by_hands));
}

bool meets_pieces(uint group, vec3 low, vec3 high) {
  PieceBox of = LOAD(32u, boxes, PIECES + group);
  if (!(all(lessThanEqual(low, of.high.xyz)) && all(lessThanEqual(of.low.xyz, high)))) return false;
  uint first = PIECES_A_GROUP * group, end = min(first + PIECES_A_GROUP, PIECES);
  for (uint q = first; q < end; ++q) {
    PieceBox b = LOAD(32u, boxes, q);
    if (all(lessThanEqual(low, b.high.xyz)) && all(lessThanEqual(b.low.xyz, high))) return true;
  }
  return false;
}

/// Whether the piece of cloth between four neighbouring vertices may meet a piece of a near group.
bool cell_meets(uint cell) {
  uint i = cell / (COLUMNS - 1u) * COLUMNS + cell % (COLUMNS - 1u);
  vec3 low = vec3(1e30), high = vec3(-1e30);
  for (uint c = 0u; c < 4u; ++c) {
    vec4 at = freely(i + c % 2u + c / 2u * COLUMNS);
    low = min(low, at.xyz - at.w);
    high = max(high, at.xyz + at.w);
  }
  for (uint n = 0u; n < near_group_count && near_any == 0u; ++n)
    if (meets_pieces(near_groups[n], low, high)) return true;
  return false;
}

/// For all threads alike. Whether the frame is to be done with contact is in the ledger. Where the last one had contact, this one has it if
/// a group of pieces is in reach: to look closer would cost a tenth of a frame on a desk.
bool is_far() {
  bool looks_closer = ledger.meets == 0u && is_slow();
  if (thread == 0u) near_any = near_group_count = farthest = 0u;
  empty_box();
  barrier();  // an empty box before it is widened
  float carried = greatest_displacement();
  rest = reach_at_rest();
  by_hands = pulled();
  uvec3 from = uvec3(kLowNone), to = uvec3(kHighNone);
  for (uint i = thread; i < COLUMNS * ROWS; i += THREADS) {
    vec4 at = LOAD16(x, i);
    widen(from, to, vec4(at.xyz, reach_at(length(LOAD16(v, i).xyz), rest, carried, by_hands)));
  }
  widen_box(from, to);
  barrier();  // the box before pieces are looked for in it
  for (uint g = thread; g < GROUPS; g += THREADS) {
    if (!meets_cloth(LOAD(32u, boxes, PIECES + g))) continue;
    uint n = atomicAdd(near_group_count, 1u);
    if (n < kMostNearGroups) near_groups[n] = g;
    if (n >= kMostNearGroups || !looks_closer) near_any = 1u;
  }
  box_low = vec3(of_ordered(cloth_low[0]), of_ordered(cloth_low[1]), of_ordered(cloth_low[2]));
  box_high = vec3(of_ordered(cloth_high[0]), of_ordered(cloth_high[1]), of_ordered(cloth_high[2]));
  barrier();  // the near groups before cells are held against them
  for (uint cell = thread; near_group_count > 0u && cell < (COLUMNS - 1u) * (ROWS - 1u) && near_any == 0u; cell += THREADS)
    if (cell_meets(cell)) near_any = 1u;
  barrier();  // every thread's look before the answer
  if (thread == 0u) ledger.far = 0u;
  return near_any == 0u;
}

/// After a substep: what has gone farther than it may can meet a piece.
void look_out() {
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    uint i = lane * K + k;
    if (!on_chain(i)) continue;
    bool stays = all(greaterThanEqual(pos[k], box_low)) && all(lessThanEqual(pos[k], box_high));
    if (stays && near_group_count > 0u) {
      vec4 at = freely(index_of(vertex(i)));
      stays = distance(pos[k], at.xyz) <= at.w;
    }
    if (!stays) near_any = 1u;
  }
}

/// What the next frame goes by.
void note_farthest() {
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    uint i = lane * K + k;
    if (on_chain(i)) atomicMax(farthest, floatBitsToUint(distance(pos[k], LOAD16(x, index_of(vertex(i))).xyz)));
  }
  barrier();  // all ways before the farthest is read
  if (thread != 0u) return;
  faults.farthest = farthest;
  ledger.farthest = farthest;
}
