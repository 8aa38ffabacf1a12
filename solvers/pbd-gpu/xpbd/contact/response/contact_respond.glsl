// A later round of response: the correction of a pair's contact at its vertices' new positions.
void respond(uint k) {
  uvec4 pair = pairs[k];
  if ((pair.z & PAIR_NEAREST) == 0u) return;
  shape = shapes[pair.y];
  uvec4 e = primitives[pair.x];
  PairState s = states[k];
  vec4 correction = contact_correction(e, s);
  mark_correction(k, e, correction != vec4(0.0), s.correction != vec4(0.0));
  states[k].correction = correction;
}
