#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "clothbench/error.hpp"
#include "report/web/page.hpp"

namespace clothbench {
namespace {

constexpr double kMostGrowth = 20;  // of a cloth that still shows something

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  const int status = compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), 6);
  if (status != Z_OK) throw Error("zlib: compress2 failed with " + std::to_string(status), ExitCode::CheckFailed);
  out.resize(size);
  return out;
}

struct Box {
  double low[3] = {0, 0, 0}, extent = 0;
  bool finite = true;
};

Box box_of(const float* position, std::size_t vertices) {
  Box b;
  double high[3];
  for (std::size_t v = 0; v < vertices; ++v)
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = position[3 * v + a];
      if (!std::isfinite(x)) b.finite = false;
      if (v == 0 || x < b.low[a]) b.low[a] = x;
      if (v == 0 || x > high[a]) high[a] = x;
    }
  for (std::size_t a = 0; a < 3 && vertices > 0; ++a) b.extent = std::max(b.extent, high[a] - b.low[a]);
  return b;
}

/// Least corner of each frame that is kept, and the common step.
std::vector<Box> frames_to_keep(const Replay& replay, std::size_t vertices, PackedMotion& out) {
  std::vector<Box> boxes;
  double extent = 0;
  for (std::size_t k = 0; k < replay.frames.size(); ++k) {
    const Box b = box_of(&replay.position[3 * vertices * k], vertices);
    if (!b.finite || (k > 0 && !(b.extent <= kMostGrowth * boxes[0].extent))) {
      out.cut_at = static_cast<long>(replay.frames[k]);
      break;
    }
    extent = std::max(extent, b.extent);
    boxes.push_back(b);
    out.frames.push_back(replay.frames[k]);
  }
  out.step_m = extent > 0 ? extent / (kPackedSteps - 1) : 1;  // one step for the corner rounded down
  return boxes;
}

std::string planes(const std::vector<std::uint32_t>& words, std::size_t bytes) {
  std::string out;
  out.reserve(words.size() * bytes);
  for (std::size_t k = 0; k < bytes; ++k)
    for (const std::uint32_t w : words) out.push_back(static_cast<char>((w >> (8 * k)) & 0xffu));
  return deflated(out);
}

}  // namespace

PackedMotion pack_motion(const Replay& replay, std::size_t columns, std::size_t rows, std::size_t grid_stride) {
  PackedMotion out;
  out.columns = every(columns, grid_stride);
  out.rows = every(rows, grid_stride);
  const std::size_t vertices = columns * rows, kept = out.columns.size() * out.rows.size();
  const std::vector<Box> boxes = frames_to_keep(replay, vertices, out);
  // X of the last two frames, (axis, vertex), in steps from the world's origin.
  std::vector<std::int64_t> now(3 * kept), before, earlier;
  std::vector<std::uint32_t> residuals;
  residuals.reserve(boxes.size() * 3 * kept);
  for (std::size_t f = 0; f < boxes.size(); ++f) {
    for (std::size_t a = 0; a < 3; ++a) {
      const auto origin = static_cast<std::int64_t>(std::floor(boxes[f].low[a] / out.step_m));
      out.origin.push_back(origin);
      std::size_t k = a * kept;
      for (const std::size_t j : out.rows)
        for (const std::size_t i : out.columns) {
          now[k] = std::llround(replay.position[3 * (f * vertices + j * columns + i) + a] / out.step_m);
          const std::int64_t predicted = f > 1           ? 2 * before[k] - earlier[k]
                                         : f == 1        ? before[k]
                                         : k % kept == 0 ? origin
                                                         : now[k - 1];
          residuals.push_back(static_cast<std::uint32_t>((now[k] - predicted) & 0xffff));
          ++k;
        }
    }
    earlier = before;
    before = now;
  }
  out.bytes = planes(residuals, 2);
  return out;
}

std::string pack_words(const std::vector<std::uint32_t>& words) { return planes(words, 4); }

std::string pack_floats(const std::vector<double>& values) {
  std::vector<std::uint32_t> words;
  words.reserve(values.size());
  for (const double v : values) words.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(v)));
  return pack_words(words);
}

std::string pack_text(const std::string& text) { return deflated(text); }

std::string base64(const std::string& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t group = 0;
    for (std::size_t b = 0; b < 3; ++b)
      group = group << 8 | (k + b < bytes.size() ? static_cast<unsigned char>(bytes[k + b]) : 0u);
    for (std::size_t d = 0; d < 4; ++d)
      out.push_back(k + d > bytes.size() ? '=' : kDigits[(group >> (18 - 6 * d)) & 63u]);
  }
  return out;
}

}  // namespace clothbench
