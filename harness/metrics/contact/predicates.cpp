#include <CGAL/MP_Float.h>

#include <cmath>
#include <utility>

#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {
namespace {

template <class T, int N>
using Square = std::array<std::array<T, N>, N>;

/// Determinant by minors of two rows (Laplace). With kPermanent all terms are added: for |entries| as input, this is
/// the sum of the terms' magnitudes. Unrolled by hand, because contact metrics spend most of their time here.
template <class T, int N, bool kPermanent = false>
T determinant(const Square<T, N>& m) {
  const auto less = [](const T& a, const T& b) -> T { return kPermanent ? a + b : a - b; };
  const auto minor = [&](int row, int i, int j) { return less(m[row][i] * m[row + 1][j], m[row][j] * m[row + 1][i]); };
  if constexpr (N == 2) {
    return minor(0, 0, 1);
  } else if constexpr (N == 3) {
    return less(m[0][0] * minor(1, 1, 2), m[0][1] * minor(1, 0, 2)) + m[0][2] * minor(1, 0, 1);
  } else {
    return less(minor(0, 0, 1) * minor(2, 2, 3), minor(0, 0, 2) * minor(2, 1, 3)) + minor(0, 0, 3) * minor(2, 1, 2) +
           less(minor(0, 1, 2) * minor(2, 0, 3), minor(0, 1, 3) * minor(2, 0, 2)) + minor(0, 2, 3) * minor(2, 0, 1);
  }
}

template <int N>
int exact_sign(const std::array<Point<N>, N>& head, const std::array<Point<N>, N>& tail) {
  Square<CGAL::MP_Float, N> m;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) m[i][j] = CGAL::MP_Float(head[i][j]) - CGAL::MP_Float(tail[i][j]);
  return static_cast<int>(CGAL::sign(determinant<CGAL::MP_Float, N>(m)));
}

/// Sign, for e -> 0+, of the determinant with shift * (e, e^2, e^3, 0) added to its last row: sign of its first term.
template <int N>
int perturbed_sign(const std::array<Point<N>, N>& head, const std::array<Point<N>, N>& tail, int shift) {
  if (const int sign = sign_of_determinant<N>(head, tail)) return sign;
  for (int column = 0; column < 3; ++column) {
    std::array<Point<N - 1>, N - 1> minor_head, minor_tail;
    for (int i = 0; i < N - 1; ++i)
      for (int j = 0, k = 0; j < N; ++j)
        if (j != column) {
          minor_head[i][k] = head[i][j];
          minor_tail[i][k++] = tail[i][j];
        }
    if (const int sign = sign_of_determinant<N - 1>(minor_head, minor_tail))
      return ((N - 1 + column) % 2 == 0 ? sign : -sign) * shift;
  }
  return 0;
}

template <int N>
int side(const Simplex<N>& v, const Point<N>& p, int shift) {
  std::array<Point<N>, N> head, tail;
  for (int i = 0; i < N - 1; ++i) head[i] = v[i + 1];
  head[N - 1] = p;
  tail.fill(v[0]);
  return perturbed_sign<N>(head, tail, shift);
}

}  // namespace

template <int N>
int sign_of_determinant(const std::array<Point<N>, N>& head, const std::array<Point<N>, N>& tail) {
  Square<double, N> m, magnitude;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) {
      m[i][j] = head[i][j] - tail[i][j];
      magnitude[i][j] = std::abs(m[i][j]);
    }
  const double value = determinant<double, N>(m);
  const double bound = determinant<double, N, true>(magnitude);
  // A term is rounded at most 4 (differences) + 3 (products) + 6 (sums) times for N = 4: 13 * 2^-53 < 2^-48. The
  // absolute bound covers underflow errors. On overflow or NaN the comparison is false.
  constexpr double kRelative = 0x1p-48, kLeast = 0x1p-900;
  if (std::abs(value) > kRelative * bound && bound > kLeast && std::isfinite(bound)) return value > 0 ? 1 : -1;
  // The sign is 0 if every term has a factor 0. This is the most common tie: points that share a coordinate.
  for (auto& row : magnitude)
    for (double& x : row) x = x == 0 ? 0 : 1;
  if (determinant<double, N, true>(magnitude) == 0) return 0;
  return exact_sign<N>(head, tail);
}

template <int N>
int crossing(const Point<N>& p, const Point<N>& q, const Simplex<N>& simplex, int shift) {
  if (p == q) return 0;
  const int side_p = side<N>(simplex, p, shift);
  const int side_q = side<N>(simplex, q, shift);
  if (side_p * side_q >= 0) return 0;
  // In a projection along the segment, p is inside if replacing any corner by p keeps the orientation det(q - p, w1 -
  // w0, ..., p - w0), where w are the corners with the replaced one moved to the end.
  int first = 0;
  for (int i = N - 1; i >= 0; --i) {
    Simplex<N> w = simplex;
    std::swap(w[i], w[N - 1]);
    std::array<Point<N>, N> head, tail;
    tail.fill(w[0]);
    head[0] = q;
    tail[0] = p;
    for (int k = 1; k < N - 1; ++k) head[k] = w[k];
    head[N - 1] = p;
    // For i = 0 the swap moves the last corner to the front, which reverses the orientation.
    const int sign = perturbed_sign<N>(head, tail, shift) * (i == N - 1 ? 1 : -1);
    if (sign == 0) return 0;
    if (i == N - 1) first = sign;
    if (sign != first) return 0;
  }
  return side_q;
}

bool is_degenerate(const Simplex<3>& triangle) {
  for (int drop = 0; drop < 3; ++drop) {
    const int j = (drop + 1) % 3, k = (drop + 2) % 3;
    const auto at = [&](int corner) { return Point<2>(triangle[corner][j], triangle[corner][k]); };
    if (sign_of_determinant<2>({at(1), at(2)}, {at(0), at(0)}) != 0) return false;
  }
  return true;
}

template int sign_of_determinant<2>(const std::array<Point<2>, 2>&, const std::array<Point<2>, 2>&);
template int sign_of_determinant<3>(const std::array<Point<3>, 3>&, const std::array<Point<3>, 3>&);
template int sign_of_determinant<4>(const std::array<Point<4>, 4>&, const std::array<Point<4>, 4>&);
template int crossing<3>(const Point<3>&, const Point<3>&, const Simplex<3>&, int);
template int crossing<4>(const Point<4>&, const Point<4>&, const Simplex<4>&, int);

}  // namespace clothbench::contact
