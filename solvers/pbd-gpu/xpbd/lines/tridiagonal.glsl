// A tridiagonal system along a chain, MATRIX a row: LOWER u[i-1] + DIAGONAL u[i] + UPPER u[i+1] = RIGHT. Every thread
// holds M consecutive rows of it. Included once for each kind of entry, with the macros SOLVE, MATRIX, VECTOR, M and
// the four arrays. Threads of a chain beyond its end hold rows of the unit matrix.
//
// Each thread eliminates its own rows until one is left (Wang 1981); those are solved by parallel cyclic reduction
// (Hockney & Jesshope 1981) in `rounds` rounds, log2(LANES) of them exactly; over several subgroups until each has a
// system of its own, then by shuffles. RIGHT becomes the solution; `before` the row before the thread's first.

/// The reduction of one row per thread, a u[i-1] + u[i] + c u[i+1] = d: d becomes the solution, d_below the row before.
void reduce_rows(uint rounds, MATRIX a, MATRIX c, inout VECTOR d, out VECTOR d_below) {
  MATRIX f, a_below, c_below, a_above, c_above;
  VECTOR d_above;
  // Past a chain's ends a and c are 0, so what a missing neighbour would say is not heard.
#define REDUCE(n) \
    exchange_row(n, a, c, d, a_below, c_below, d_below, a_above, c_above, d_above); \
    f = inverse_of(MATRIX(1.0) - a * c_below - c * a_above); \
    d = f * (d - a * d_below - c * d_above); \
    a = -(f * (a * a_below)); \
    c = -(f * (c * c_above));
  if (PARTS > 1u) {
    [[unroll]] for (uint n = 1u; n < PARTS; n <<= 1u) {
      if (rounds == 0u) break;
      REDUCE(n)
      --rounds;
    }
    to_part(a, c, d);
    apart = true;
    [[unroll]] for (uint n = 1u; n < PART; n <<= 1u) {
      if (rounds == 0u) break;
      REDUCE(n)
      --rounds;
    }
    apart = false;
    from_part(d, d_below);
  } else
  {
    for (uint n = 1u; n < LANES && rounds > 0u; n <<= 1u, --rounds) { REDUCE(n) }
    exchange_row(1u, a, c, d, a_below, c_below, d_below, a_above, c_above, d_above);
  }
#undef REDUCE
}

void SOLVE(uint rounds, out VECTOR before) {
  MATRIX f = inverse_of(DIAGONAL[0]);
  LOWER[0] = f * LOWER[0];
  UPPER[0] = f * UPPER[0];
  RIGHT[0] = f * RIGHT[0];
  // Forwards: u[k] = RIGHT[k] - LOWER[k] before - UPPER[k] u[k+1].
  [[unroll]] for (uint k = 1u; k < M; ++k) {
    f = inverse_of(DIAGONAL[k] - LOWER[k] * UPPER[k - 1u]);
    RIGHT[k] = f * (RIGHT[k] - LOWER[k] * RIGHT[k - 1u]);
    UPPER[k] = f * UPPER[k];
    LOWER[k] = -(f * (LOWER[k] * LOWER[k - 1u]));
  }
  // Backwards, all but the last: u[k] = RIGHT[k] - LOWER[k] before - UPPER[k] last.
  [[unroll]] for (uint j = 2u; j < M; ++j) {
    uint k = M - 1u - j;
    RIGHT[k] -= UPPER[k] * RIGHT[k + 1u];
    LOWER[k] -= UPPER[k] * LOWER[k + 1u];
    UPPER[k] = -(UPPER[k] * UPPER[k + 1u]);
  }
  const uint last = M - 1u;
  // The next thread's first row in terms of this thread's last and its own last; a thread of one row is its own last.
  MATRIX zero = MATRIX(0.0);
  MATRIX a, c, a_below, c_below;
  VECTOR d, d_below;
  MATRIX a_above = M > 1u ? LOWER[0] : zero, c_above = M > 1u ? UPPER[0] : -MATRIX(1.0);
  VECTOR d_above = M > 1u ? RIGHT[0] : RIGHT[0] - RIGHT[0];
  exchange_row(1u, a_above, c_above, d_above, a_below, c_below, d_below, a_above, c_above, d_above);
  f = inverse_of(MATRIX(1.0) - UPPER[last] * a_above);
  a = f * LOWER[last];
  c = -(f * (UPPER[last] * c_above));
  d = f * (RIGHT[last] - UPPER[last] * d_above);
  reduce_rows(rounds, a, c, d, d_below);
  before = lane > 0u ? d_below : d - d;
  RIGHT[last] = d;
  [[unroll]] for (uint k = 0u; k < last; ++k) RIGHT[k] -= LOWER[k] * before + UPPER[k] * d;
}
#undef SOLVE
#undef MATRIX
#undef VECTOR
#undef M
#undef LOWER
#undef DIAGONAL
#undef UPPER
#undef RIGHT
