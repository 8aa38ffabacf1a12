// Pairs of an element and a piece whose boxes meet, the element's grown by its vertices' reaches. First they are counted, for the greatest
// share of the reaches that the list has place for, then written.
vec3 low, high;
void box_for(uvec4 e, float share) {
  low = vec3(1e30);
  high = vec3(-1e30);
  float drifts = drift_m();
  for (uint c = 0u; c < e.w; ++c) {
    vec4 r = LOAD16(reaches, e[c]);
    low = min(low, r.xyz - share * (r.w + drifts));
    high = max(high, r.xyz + share * (r.w + drifts));
  }
}
#ifdef PLANE_FRAME
vec3 free_low, free_high;  // in a frame in which the cloth meets no collider
void free_box_for(uvec4 e) {
  free_low = vec3(1e30);
  free_high = vec3(-1e30);
  for (uint c = 0u; c < e.w; ++c) {
    vec4 r = starts[e[c]];
    free_low = min(free_low, r.xyz - r.w);
    free_high = max(free_high, r.xyz + r.w);
  }
}
bool meets_freely(PieceBox b) {
  return all(lessThanEqual(free_low, b.high.xyz)) && all(lessThanEqual(b.low.xyz, free_high));
}
#endif
bool meets(PieceBox b) {
  return all(lessThanEqual(low, b.high.xyz)) && all(lessThanEqual(b.low.xyz, high));
}

// Lanes of a team, where there is one, look at boxes for the same element. Each looks at a few at a time: their loads do not wait for one
// another. All lanes of a subgroup come along.
#ifdef PLANE_FRAME
#define LIST_TEAM TEAM
#define LIST_LANE team_lane()
uint of_team(uint bits) {
  for (uint n = TEAM >> 1u; n > 0u; n >>= 1u) bits |= subgroupShuffleXor(bits, n);
  return bits;
}
#define ANY_IN_SUBGROUP(bits) (TEAM > 1u ? most_of_subgroup(bits) != 0u : (bits) != 0u)
#else
#define LIST_TEAM 1u
#define LIST_LANE 0u
uint of_team(uint bits) { return bits; }
#define ANY_IN_SUBGROUP(bits) ((bits) != 0u)
#endif
const uint kBoxesAtOnce = 4u, kBoxesATurn = kBoxesAtOnce * LIST_TEAM;
/// A bit for each of the pieces from `first` on, and before `end`, whose box meets the element's; `own`: of those that this lane looked at.
uint pieces_met(uint first, uint end, out uint own) {
  own = 0u;
  [[unroll]] for (uint n = 0u; n < kBoxesAtOnce; ++n) {
    uint of = n * LIST_TEAM + LIST_LANE;
    if (meets(LOAD(32u, boxes, min(first + of, PIECES - 1u))) && first + of < end) own |= 1u << of;
  }
  return of_team(own);
}

// A bit stands for one group, and for several of them where there are very many.
#define MOST_GROUP_WORDS 1024u
#define GROUPS_A_BIT ((GROUPS + 32u * MOST_GROUP_WORDS - 1u) / (32u * MOST_GROUP_WORDS))
#define GROUP_WORDS ((GROUPS + 31u) / 32u < MOST_GROUP_WORDS ? (GROUPS + 31u) / 32u : MOST_GROUP_WORDS)
#ifdef PLANE_FRAME
shared uint near_groups[GROUP_WORDS + 1u];
#define NEAR_GROUPS(word) near_groups[word]
#else
#define NEAR_GROUPS(word) ~0u
#endif
/// The next few of the groups with a bit that meet the element; the bits looked at are cleared.
uint groups_met(inout uint bits, uint word, uint part) {
  uint met = 0u, last = bits;
  for (uint n = 0u; n < kBoxesATurn && last != 0u; ++n) last &= last - 1u;
  uint turn_bits = bits ^ last;
  bits = last;
  for (uint n = 0u; n < LIST_LANE; ++n) turn_bits &= turn_bits - 1u;
  [[unroll]] for (uint n = 0u; n < kBoxesAtOnce; ++n) {
    uint g = GROUPS_A_BIT * (32u * word + uint(findLSB(turn_bits))) + part;
    if (turn_bits != 0u && g < GROUPS && meets(LOAD(32u, boxes, PIECES + g))) met |= turn_bits & -turn_bits;
    for (uint k = 0u; k < LIST_TEAM; ++k) turn_bits &= turn_bits - 1u;
  }
  return of_team(met);
}
// Pieces of all groups that meet the element: `q`, and `met`, a bit for each of the few pieces from there on; `own`: those of this lane.
#define EACH_PIECES_MET(BODY)                                                                              \
  for (uint part = 0u; part < GROUPS_A_BIT; ++part)                                                       \
    for (uint word = 0u; word < GROUP_WORDS; ++word)                                                     \
      for (uint bits = NEAR_GROUPS(word); bits != 0u;)                                                   \
        for (uint groups = groups_met(bits, word, part); ANY_IN_SUBGROUP(groups); groups &= groups - 1u) { \
          uint first = PIECES_A_GROUP * (GROUPS_A_BIT * (32u * word + uint(max(findLSB(groups), 0))) + part); \
          uint last = groups != 0u ? min(first + PIECES_A_GROUP, PIECES) : 0u;                           \
          for (uint step = 0u; step < PIECES_A_GROUP; step += kBoxesATurn) {                             \
            uint q = first + step, own, met = pieces_met(q, last, own);                                  \
            BODY                                                                                         \
          }                                                                                              \
        }

void write_pair(uint at, uint element, uint of_piece) {
  STORE16(pairs, at, uvec4(element, of_piece, 0u, 0u))
  states[at].normal = vec4(0.0);
  states[at].push = vec4(0.0);
}

/// Place of a piece among those of a turn.
uint place_in(uint met, uint bit) { return uint(bitCount(met & ((1u << bit) - 1u))); }

/// Writes the `count` first pairs of element k, from place `at` on.
void fill_pairs(uint k, float share, uint at, uint count) {
  box_for(LOAD16(elements, k), share);
  uint end = at + count;
  EACH_PIECES_MET(
    for (; own != 0u; own &= own - 1u) {
      uint bit = uint(findLSB(own));
      uint to = at + place_in(met, bit);
      if (to < end) write_pair(to, k, q + bit);
    }
    at += uint(bitCount(met));
  )
}

/// Lists the vertices that pairs of their own or of their triangles may move, in no fixed order, and marks them.
void list_touched(uint i) {
  uint pairs_of = LOAD16(ranges, TRIANGLES + i).y;
  for (uint f = LOAD4(fans, i), end = LOAD4(fans, i + 1u); f < end; ++f) pairs_of += LOAD16(ranges, LOAD4(fans, f) / 4u).y;
  STORE4(touched, OF_PAIRS(i), pairs_of);
  if (pairs_of == 0u) return;
  STORE4(touched, atomicAdd(ledger.touched_vertices, 1u), i);
}

/// Pairs of element k where its vertices go no farther than a share of their reaches.
uint pairs_at(uint k, float share) {
  box_for(LOAD16(elements, k), share);
  uint n = 0u;
  EACH_PIECES_MET(n += uint(bitCount(met));)
  return n;
}
