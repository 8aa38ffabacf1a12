// A further round of responses: the proposed correction of a pair's contact at its vertices' new places.
void respond(uint k) {
  uvec4 pair = LOAD16(pairs, k);
  if ((pair.z & PAIR_NEAREST) == 0u) return;
  piece = pieces[pair.y];
  states[k].push = push_of(LOAD16(elements, pair.x), states[k]);
}
