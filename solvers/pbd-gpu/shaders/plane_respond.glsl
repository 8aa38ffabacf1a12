// A further round of responses: the proposed correction of a pair's contact at its vertices' new places.
void respond(uint k) {
  uvec4 pair = LOAD16(pairs, k);
  if ((pair.z & PAIR_NEAREST) == 0u) return;
  piece = pieces[pair.y];
  uvec4 e = LOAD16(elements, pair.x);
  PairState s = states[k];
  vec4 push = push_of(e, s);
  mark_push(k, e, push != vec4(0.0), s.push != vec4(0.0));
  states[k].push = push;
}
