#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "results/store.hpp"

namespace clothbench {

/// Steps that the largest extent of a cloth is divided into: positions then fit a signed 16-bit integer.
inline constexpr double kPackedSteps = 32766;

/// A cloth's motion, thinned and quantised for the page of a report.
/// Frame f, axis a, vertex v: x = step_m · (origin[3f + a] + u), u in [0, 32766]. `bytes`: zlib of all low bytes, then
/// all high bytes, of the residuals r (frame, axis, vertex; modulo 2^16) between X = origin + u and its prediction X'.
/// X' = 2 X(f-1) - X(f-2); in frame 1, X' = X(0); in frame 0, X' is the previous vertex, and for vertex 0 the origin.
struct PackedMotion {
  std::vector<std::size_t> frames;         ///< those of the run that are kept
  std::vector<std::size_t> columns, rows;  ///< those of the cloth's grid that are kept
  double step_m = 0;
  std::vector<std::int64_t> origin;  ///< (frame, axis), in steps
  std::string bytes;
  /// First frame left out because the cloth is not finite or has 20 times its initial extent; -1: none.
  long cut_at = -1;
};

/// Packs a replay (frames × columns × rows): every `grid_stride`-th row and column, and the last ones. The result has
/// no frames if the first is not finite.
PackedMotion pack_motion(const Replay&, std::size_t columns, std::size_t rows, std::size_t grid_stride);

/// zlib (RFC 1950) of the bytes of `words` in little-endian order, all first bytes, then all second, and so on.
std::string pack_words(const std::vector<std::uint32_t>& words);
std::string pack_floats(const std::vector<double>& values);  ///< the same, with each value as a 32-bit float

std::string base64(const std::string&);

}  // namespace clothbench
