#include "xpbd/lines/line_layout.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"

namespace clothbench::pbd_gpu {

std::vector<std::uint8_t> over_constrained_lines(const Scene& scene) {
  const Cloth& c = scene.cloth;
  const int largest = std::max(c.columns, c.rows);
  std::vector<std::uint8_t> over_constrained(4 * static_cast<std::size_t>(largest), 0);
  std::vector<std::uint8_t> held(c.vertex_count(), 0);
  for (const std::uint32_t v : scene.pins.vertices) held[v] = 1;
  for (const std::uint32_t v : scene.grips.vertices) held[v] = 1;
  const std::vector<double> x = initial_positions(scene);
  // If the chord is shorter than this fraction of the chain, the chain can sag and its system has full rank.
  constexpr double kStraight = 0.99;
  const int steps[4][2] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}};
  for (int colour = 0; colour < 4; ++colour) {
    const auto [di, dj] = std::pair(steps[colour][0], steps[colour][1]);
    const double link = std::hypot(di * c.du(), dj * c.dv());
    for (std::uint32_t v = 0; v < held.size(); ++v) {
      if (held[v] == 0) continue;
      const int i = static_cast<int>(v) % c.columns, j = static_cast<int>(v) / c.columns;
      for (int n = 1, a = i + di, b = j + dj; a >= 0 && a < c.columns && b < c.rows; ++n, a += di, b += dj) {
        const auto other = static_cast<std::size_t>(b * c.columns + a);
        if (held[other] == 0) continue;
        const int chain = colour == 0   ? j
                          : colour == 1 ? i
                          : colour == 2 ? (i - j % c.columns + c.columns) % c.columns
                                        : (i + j) % c.columns;
        if (n > 1 &&
            (!scene.grips.vertices.empty() || norm(minus(vertex_at(x, other), vertex_at(x, v))) > kStraight * n * link))
          over_constrained[static_cast<std::size_t>(colour * largest + chain)] = 1;
        break;
      }
    }
  }
  return over_constrained;
}

LineShape frame_shape(int columns, int rows, const LineRequest& request, const LineDevice& device) {
  const std::uint32_t vertices = request.vertices;
  const auto longest = static_cast<std::uint32_t>(std::max(columns, rows));
  if (longest > 32) return {};
  const std::uint32_t first = vertices != 0 ? vertices : device.wide ? 2 : 4;
  for (const std::uint32_t k : {first, 4u, 8u, 16u}) {
    if (vertices != 0 && k != vertices) continue;
    LineShape s{std::bit_ceil((longest + k - 1) / k), k, 0};
    const bool fits_subgroup = s.lanes <= device.subgroup;
    // Whole subgroups, so that thread and lane numbers agree, and at least one thread for each row.
    const std::uint32_t whole = std::max(device.subgroup, 32u);
    s.threads = (s.lanes * longest + whole - 1) / whole * whole;
    const std::uint32_t state_B =
        (request.corrects_splitting ? 10 : 6) * 4 * 34 * static_cast<std::uint32_t>(rows) + 128;
    // With two vertices per thread, large workgroups are faster if a line fits in a subgroup.
    const std::uint32_t largest =
        k < 4 && (fits_subgroup || vertices != 0) ? device.max_threads : std::min(256u, device.max_threads);
    if (s.threads <= largest && state_B + (fits_subgroup ? 16 : 32 * s.threads) <= device.shared_B) return s;
  }
  return {};
}

/// Shared memory that a barrier over all workgroups uses.
constexpr std::uint32_t kBarrier_B = 16;

LineShape pass_shape(int length, const LineRequest& request, const LineDevice& device) {
  const auto n = static_cast<std::uint32_t>(length);
  const bool select_plane = device.wide;
  const std::uint32_t vertices = request.vertices != 0 ? request.vertices : select_plane && n <= 384 ? 2 : 4;
  const std::uint32_t beside = request.beside != 0 ? request.beside : !select_plane || n <= 192 ? 1 : n <= 384 ? 2 : 4;
  // A requested number of threads is used in full; otherwise the smallest number that holds whole subgroups and lines.
  const std::uint32_t largest = std::min(request.threads != 0 ? request.threads
                                         : select_plane       ? 1024u
                                                              : 256u,
                                         device.max_threads);
  const std::uint32_t smallest =
      request.threads != 0 ? largest : std::min(select_plane ? device.subgroup : 64u, largest);
  for (const std::uint32_t k : {2u, 4u, 8u, 16u, 32u}) {
    const std::uint32_t lanes = std::bit_ceil((n + k - 1) / k);
    if (k < vertices || lanes * beside > largest) continue;
    LineShape s{lanes, k, std::max(lanes * beside, smallest), beside};
    // Whole subgroups, so that thread and lane numbers agree.
    s.threads = (s.threads + device.subgroup - 1) / device.subgroup * device.subgroup;
    const bool exchange = lanes * beside > device.subgroup;
    if ((exchange ? 32 * s.threads : 0) + kBarrier_B <= device.shared_B) return s;
  }
  throw Error("solver xpbd: a cloth of " + std::to_string(length) + " vertices per side; expected at most " +
              std::to_string(32 * largest / beside));
}

std::uint32_t bend_rounds(double alpha, double max_inverse_mass, const LineShape& shape) {
  const auto all = static_cast<std::uint32_t>(std::countr_zero(shape.lanes));
  // Entries of the inverse of a matrix of bandwidth 2 decay at least like q^(distance from the diagonal / 2).
  const double q = 10 * max_inverse_mass / (6 * max_inverse_mass + alpha);
  for (std::uint32_t rounds = 0; rounds < all; ++rounds)
    if (q < 1 && std::pow(q, shape.vertices * std::exp2(rounds) / 2) < 1e-7) return rounds;
  return all;
}

}  // namespace clothbench::pbd_gpu
