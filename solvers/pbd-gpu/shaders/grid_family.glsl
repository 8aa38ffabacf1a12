// Which vertices constraint k of a coloured family joins. Lines of a family are taken every `stride`-th: along i for
// the rows (dj = 0), along j otherwise.
uvec2 first_vertex(uint k) {
  uint fast = k % p.along, slow = k / p.along;
  return p.dj == 0 ? uvec2(p.colour + p.stride * slow, fast) : uvec2(p.i_first + fast, p.colour + p.stride * slow);
}
uint index_of(uvec2 at) { return at.y * p.columns + at.x; }
uint step_of() { return uint(int(p.columns) * p.dj + p.di); }

/// Border lines carry half the width: the first and last row for constraints along i, column for those along j.
float compliance(uvec2 at) {
  bool border = p.dj == 0 ? at.y == 0u || at.y == p.rows - 1u : at.x == 0u || at.x == p.columns - 1u;
  return border && (p.di == 0 || p.dj == 0) ? p.alpha_border : p.alpha;
}
