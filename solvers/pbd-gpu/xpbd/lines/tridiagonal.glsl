// Solves a tridiagonal system along a chain, LOWER u[i-1] + DIAGONAL u[i] + UPPER u[i+1] = RIGHT, with entries of type
// MATRIX. Each thread holds M consecutive rows; threads beyond the chain's end hold rows of the unit matrix. Included
// once per type of entry, with the macros SOLVE, MATRIX, VECTOR, M and the four arrays.
//
// Each thread eliminates rows until it has one left (Wang 1981). Parallel cyclic reduction (Hockney & Jesshope 1981)
// solves these rows in `rounds` rounds, exactly if there are log2(LANES): through shared memory until each subgroup has
// a separate system, then by shuffles. RIGHT becomes the solution, `before` the previous thread's last solution.

/// Reduces one row per thread, a u[i-1] + u[i] + c u[i+1] = d: d becomes the solution, d_below the previous row's.
void reduce_rows(uint rounds, MATRIX a, MATRIX c, inout VECTOR d, out VECTOR d_below) {
  MATRIX f, a_below, c_below, a_above, c_above;
  VECTOR d_above;
  // Where a row has no neighbour below or above, a or c is 0, so what is read for that neighbour has no effect.
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
  // The next thread's first row now couples only the two threads' last unknowns. With M = 1 it is that thread's last.
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
