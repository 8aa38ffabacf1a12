// A frame in which the cloth cannot meet a collider: as far as it may go there is no piece. It needs neither pairs nor planes, and has the
// motion of a cloth without colliders, bit for bit. Should it leave that box all the same, nothing is stored, and the frame is begun anew
// with contact.
vec3 box_low, box_high;

/// For all threads alike. Whether the frame is to be done with contact is in the ledger.
bool is_far() {
  if (thread == 0u) near_any = 0u;
  empty_box();
  barrier();  // an empty box before it is widened
  float carried = greatest_displacement();
  uvec3 from = uvec3(kLowNone), to = uvec3(kHighNone);
  for (uint i = thread; i < COLUMNS * ROWS; i += THREADS) {
    vec4 at = LOAD16(x, i);
    widen(from, to, vec4(at.xyz, reach_from(i, at, carried)));
  }
  widen_box(from, to);
  barrier();  // the box before pieces are looked for in it
  for (uint g = thread; g < GROUPS; g += THREADS)
    if (meets_cloth(LOAD(32u, boxes, PIECES + g))) near_any = 1u;
  box_low = vec3(of_ordered(cloth_low[0]), of_ordered(cloth_low[1]), of_ordered(cloth_low[2]));
  box_high = vec3(of_ordered(cloth_high[0]), of_ordered(cloth_high[1]), of_ordered(cloth_high[2]));
  barrier();  // every thread's look before the answer
  if (thread == 0u) ledger.far = 0u;
  return near_any == 0u;
}

/// After a substep: what has left the box may meet a piece.
void look_out() {
  [[unroll]] for (uint k = 0u; k < K; ++k)
    if (on_chain(lane * K + k) && !(all(greaterThanEqual(pos[k], box_low)) && all(lessThanEqual(pos[k], box_high)))) near_any = 1u;
}
