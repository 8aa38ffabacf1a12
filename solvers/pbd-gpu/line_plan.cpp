#include "line_plan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>

#include "chain_plan.hpp"
#include "clothbench/error.hpp"
#include "clothbench/motion.hpp"
#include "clothbench/solver.hpp"
#include "prediction.hpp"
#include "substeps.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Each connected group of pinned vertices as the rectangle that it fills, or its first vertex if it fills none.
std::vector<PinnedRectangle> rectangles(const Cloth& c, const std::vector<std::uint32_t>& pinned) {
  const auto columns = static_cast<std::uint32_t>(c.columns), rows = static_cast<std::uint32_t>(c.rows);
  std::vector<std::uint8_t> left(c.vertex_count(), 0);
  for (const std::uint32_t v : pinned) left[v] = 1;
  std::vector<PinnedRectangle> found;
  for (std::uint32_t v = 0; v < left.size(); ++v) {
    if (left[v] == 0) continue;
    PinnedRectangle r{v % columns, v / columns, v % columns, v / columns};
    std::size_t count = 0;
    std::vector<std::uint32_t> next = {v};
    left[v] = 0;
    while (!next.empty()) {
      const std::uint32_t i = next.back() % columns, j = next.back() / columns;
      next.pop_back();
      ++count;
      r = {std::min(r.first_column, i), std::min(r.first_row, j), std::max(r.last_column, i), std::max(r.last_row, j)};
      for (const auto& [a, b] : {std::pair{i + 1, j}, {i - 1, j}, {i, j + 1}, {i, j - 1}}) {
        if (a >= columns || b >= rows || left[b * columns + a] == 0) continue;
        left[b * columns + a] = 0;
        next.push_back(b * columns + a);
      }
    }
    const bool full = count == std::size_t{r.last_column - r.first_column + 1} * (r.last_row - r.first_row + 1);
    found.push_back(full ? r : PinnedRectangle{v % columns, v / columns, v % columns, v / columns});
  }
  return found;
}

/// True if the cloth starts within its tethers. Else its pins are too far apart for its length, or it starts stretched.
bool start_within(const Scene& s, const Tethers& t) {
  const Cloth& c = s.cloth;
  const std::vector<double> x = initial_positions(s);
  for (int j = 0; j < c.rows; ++j)
    for (int i = 0; i < c.columns; ++i)
      for (const PinnedRectangle& r : t.to) {
        const int a = std::clamp(i, static_cast<int>(r.first_column), static_cast<int>(r.last_column)),
                  b = std::clamp(j, static_cast<int>(r.first_row), static_cast<int>(r.last_row));
        const double u = std::abs(i - a) * c.du(), v = std::abs(j - b) * c.dv();
        const double reach = s.needs.has(Feature::Shear) ? std::hypot(u, v) : u + v;
        const auto at = [&](int column, int row, std::size_t k) {
          return x[3 * static_cast<std::size_t>(row * c.columns + column) + k];
        };
        Vec3 e{};
        for (std::size_t k = 0; k < 3; ++k) e[k] = at(i, j, k) - at(a, b, k);
        if (!(norm(e) <= t.stretch * reach + 1e-6 * c.width_m)) return false;
      }
  return true;
}

}  // namespace

double tether_stretch(const Scene& scene) {
  const Cloth& c = scene.cloth;
  const auto Y = scene.material.membrane_stiffness_N_per_m;
  if (!Y) return 1;
  const double rho = c.areal_density_kg_per_m2, length = std::hypot(c.width_m, c.height_m);
  const double slack =
      5 * rho * norm(scene.gravity_m_per_s2) * length / *Y + 2 * norm(c.initial_velocity_m_per_s) * std::sqrt(rho / *Y);
  return 1 + std::min(slack, scene.material.strain_limit.value_or(slack));
}

Tethers tethers_of(const Scene& scene) {
  Tethers t;
  const Cloth& c = scene.cloth;
  if (!scene.grips.vertices.empty()) {
    t.why_not = "hands move what holds the cloth";
    return t;
  }
  if (scene.pins.vertices.empty()) {
    t.why_not = "nothing is pinned";
    return t;
  }
  t.to = rectangles(c, scene.pins.vertices);
  if (t.to.size() > Tethers::kMost) t.to.resize(Tethers::kMost);
  t.stretch = tether_stretch(scene);
  if (!start_within(scene, t)) {
    t.to.clear();
    t.why_not = "the cloth starts stretched";
  }
  return t;
}

std::vector<std::uint8_t> taut_chains(const Scene& scene) {
  const Cloth& c = scene.cloth;
  const int most = std::max(c.columns, c.rows);
  std::vector<std::uint8_t> taut(4 * static_cast<std::size_t>(most), 0);
  std::vector<std::uint8_t> held(c.vertex_count(), 0);
  for (const std::uint32_t v : scene.pins.vertices) held[v] = 1;
  for (const std::uint32_t v : scene.grips.vertices) held[v] = 1;
  const std::vector<double> x = initial_positions(scene);
  // If the chord is shorter than this share of the chain, the chain can sag and its system has full rank.
  constexpr double kTaut = 0.99;
  const int steps[4][2] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}};
  for (int family = 0; family < 4; ++family) {
    const auto [di, dj] = std::pair(steps[family][0], steps[family][1]);
    const double link = std::hypot(di * c.du(), dj * c.dv());
    for (std::uint32_t v = 0; v < held.size(); ++v) {
      if (held[v] == 0) continue;
      const int i = static_cast<int>(v) % c.columns, j = static_cast<int>(v) / c.columns;
      for (int n = 1, a = i + di, b = j + dj; a >= 0 && a < c.columns && b < c.rows; ++n, a += di, b += dj) {
        const auto other = static_cast<std::size_t>(b * c.columns + a);
        if (held[other] == 0) continue;
        Vec3 e{};
        for (std::size_t k = 0; k < 3; ++k) e[k] = x[3 * other + k] - x[3 * v + k];
        const int chain = family == 0   ? j
                          : family == 1 ? i
                          : family == 2 ? (i - j % c.columns + c.columns) % c.columns
                                        : (i + j) % c.columns;
        if (n > 1 && (!scene.grips.vertices.empty() || norm(e) > kTaut * n * link))
          taut[static_cast<std::size_t>(family * most + chain)] = 1;
        break;
      }
    }
  }
  return taut;
}

bool is_tethered(const Scene& scene, const nlohmann::json& settings) {
  return settings.value("tethers", true) &&
         (wants_chains(scene) ? tether_table(scene).a_vertex > 0 : !tethers_of(scene).to.empty());
}

LineShape frame_shape(int columns, int rows, const LineRequest& request, const LineDevice& device) {
  const std::uint32_t vertices = request.vertices;
  const auto longest = static_cast<std::uint32_t>(std::max(columns, rows));
  if (longest > 32) return {};
  const std::uint32_t first = vertices != 0 ? vertices : device.wide ? 2 : 4;
  for (const std::uint32_t k : {first, 4u, 8u, 16u}) {
    if (vertices != 0 && k != vertices) continue;
    LineShape s{std::bit_ceil((longest + k - 1) / k), k, 0, false};
    s.shuffles = s.lanes <= device.subgroup;
    if (s.shuffles) s.beside = request.beside != 0 ? request.beside : 1;
    // Whole subgroups, so that thread and lane numbers agree, and at least one thread for each row of held vertices.
    const std::uint32_t whole = std::max(device.subgroup, 32u);
    s.threads = (s.lanes * longest + whole - 1) / whole * whole;
    const std::uint32_t state_B = (request.couples ? 10 : 6) * 4 * 34 * static_cast<std::uint32_t>(rows) + 128;
    // Twice the threads are faster with shuffles, not with barriers.
    const std::uint32_t most =
        k < 4 && (s.shuffles || vertices != 0) ? device.most_threads : std::min(256u, device.most_threads);
    if (s.threads <= most && state_B + (s.shuffles ? 0 : 16 * s.threads) <= device.shared_B) return s;
  }
  return {};
}

/// Shared memory that a barrier over all workgroups uses.
constexpr std::uint32_t kBarrier_B = 16;

LineShape pass_shape(int length, const LineRequest& request, const LineDevice& device) {
  const auto n = static_cast<std::uint32_t>(length);
  const bool choose = device.wide && device.subgroup > 0;
  const std::uint32_t vertices = request.vertices != 0 ? request.vertices : choose && n <= 384 ? 2 : 4;
  const std::uint32_t beside = device.subgroup == 0  ? 1
                               : request.beside != 0 ? request.beside
                               : !choose || n <= 192 ? 1
                               : n <= 384            ? 2
                                                     : 4;
  // A requested number of threads is used in full; else the fewest that hold whole subgroups and lines.
  const std::uint32_t most = std::min(request.threads != 0 ? request.threads
                                      : choose             ? 1024u
                                                           : 256u,
                                      device.most_threads);
  const std::uint32_t least = request.threads != 0 ? most : std::min(choose ? device.subgroup : 64u, most);
  for (const std::uint32_t k : {2u, 4u, 8u, 16u, 32u}) {
    const std::uint32_t lanes = std::bit_ceil((n + k - 1) / k);
    if (k < vertices || lanes * beside > most) continue;
    LineShape s{lanes, k, std::max(lanes * beside, least), device.subgroup > 0, beside};
    // Whole subgroups, so that thread and lane numbers agree.
    if (s.shuffles) s.threads = (s.threads + device.subgroup - 1) / device.subgroup * device.subgroup;
    const bool exchange = !s.shuffles || lanes * beside > device.subgroup;
    if ((exchange ? 32 * s.threads : 0) + kBarrier_B <= device.shared_B) return s;
  }
  throw Error("solver xpbd: a cloth of " + std::to_string(length) + " vertices a side; expected at most " +
              std::to_string(32 * most / beside));
}

std::uint32_t bend_rounds(double alpha, double most_inverse_mass, const LineShape& shape) {
  const auto all = static_cast<std::uint32_t>(std::countr_zero(shape.lanes));
  // Entries of the inverse of a matrix of bandwidth 2 decay at least like q^(distance from the diagonal / 2).
  const double q = 10 * most_inverse_mass / (6 * most_inverse_mass + alpha);
  for (std::uint32_t rounds = 0; rounds < all; ++rounds)
    if (q < 1 && std::pow(q, shape.vertices * std::exp2(rounds) / 2) < 1e-7) return rounds;
  return all;
}

}  // namespace clothbench::pbd_gpu
