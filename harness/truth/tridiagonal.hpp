#pragma once
#include <cstddef>
#include <span>

namespace clothbench::truth {

/// Solves a symmetric positive definite tridiagonal system in place (elimination without pivoting; allocates nothing,
/// so it can run inside an integrator's right-hand side). `off[i]` couples i and i + 1. `diagonal` is overwritten,
/// `rhs` becomes the solution.
inline void solve_tridiagonal(std::span<double> diagonal, std::span<const double> off, std::span<double> rhs) {
  const std::size_t n = diagonal.size();
  for (std::size_t i = 1; i < n; ++i) {
    const double factor = off[i - 1] / diagonal[i - 1];
    diagonal[i] -= factor * off[i - 1];
    rhs[i] -= factor * rhs[i - 1];
  }
  for (std::size_t i = n; i-- > 0;) rhs[i] = (rhs[i] - (i + 1 < n ? off[i] * rhs[i + 1] : 0)) / diagonal[i];
}

}  // namespace clothbench::truth
