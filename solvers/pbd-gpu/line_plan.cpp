#include "line_plan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "chain_plan.hpp"
#include "clothbench/error.hpp"
#include "clothbench/motion.hpp"
#include "clothbench/solver.hpp"
#include "prediction.hpp"

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
  return 1 + 5 * rho * norm(scene.gravity_m_per_s2) * length / *Y +
         2 * norm(c.initial_velocity_m_per_s) * std::sqrt(rho / *Y);
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

namespace {

/// Substeps in which a moving collider, or a cloth that falls or is thrown on what stands, moves by so many margins. A
/// struck vertex then pulls its neighbours along before the links between are overstretched. On what stands much of the
/// cloth is struck at once, so that the way is also at most so many quarters of a cell.
double substeps_by_margins(const Scene& scene, double margins) {
  constexpr double kLeast = 0.125, kMostOnImpact = 0.25;  // of a cell
  const double cell = std::min(scene.cloth.du(), scene.cloth.dv()), impact = impact_speed_m_per_s(scene);
  double margin = std::numeric_limits<double>::infinity();
  for (const Collider& c : scene.colliders) margin = std::min(margin, std::max(c.margin_m, kLeast * cell));
  if (!(margin < std::numeric_limits<double>::infinity())) return 1;
  if (impact > 0) margin = std::min(margin, kMostOnImpact * cell);
  const double speed = collider_speed_m_per_s(scene) + norm(scene.cloth.initial_velocity_m_per_s);
  return std::ceil(std::max(speed, impact) * scene.time.dt() / (margins * margin));
}

/// Nothing is passed with any number (PLANES.md), so that this is a matter of quality, and may be capped by what a
/// frame may cost. A margin a substep (fast: two, accurate: a half), at a margin of 4 mm up to 9.2 m/s.
constexpr double kMargins[] = {2, 1, 0.5}, kBudget[] = {16, 32, 64}, kBudgetOnImpact[] = {32, 64, 96};
double substeps_for_speed(const Scene& scene, int quality) {
  const double* budget = impact_speed_m_per_s(scene) > 0 ? kBudgetOnImpact : kBudget;
  return std::min(budget[quality], substeps_by_margins(scene, kMargins[quality]));
}

/// A frame in which gravity takes the cloth far stands for several: what it swings through in a substep grows with
/// dt sqrt(g / L), so that above kMost of it substeps grow with the square root of gravity.
double frames_for_gravity(const Scene& scene) {
  constexpr double kMost = 0.15;
  const double longer = std::max(scene.cloth.width_m, scene.cloth.height_m);
  const double swing = scene.time.dt() * std::sqrt(norm(scene.gravity_m_per_s2) / longer);
  return swing > kMost && is_held(scene) && touches_nothing(scene) ? swing / kMost : 1;
}

/// Most substeps that a sheet takes so that its modulus is Y: up to Y dt^2/(rho L^2) of about 0.0028, 2000 N/m on 1 m.
double most_to_couple(double links) { return std::max(6.0, links / 6); }

int quality_of(const nlohmann::json& settings) {
  const std::string quality = settings.value("quality", "default");
  return quality == "fast" ? 0 : quality == "default" ? 1 : 2;
}

double length(const Vec3& v) { return std::hypot(v[0], v[1], v[2]); }

/// If layers approach by more than kMostWay of their thickness in a substep, responses cannot part them and planes cut
/// the ways of vertices (PLANES.md, "The cloth with itself"). The assumed speed is the sum of the scene's initial
/// speed, that of a fall by the cloth's length, and that of the fastest grip or collider.
double substeps_for_layers(const Scene& scene) {
  constexpr double kMostWay = 2.0 / 3;
  const Cloth& c = scene.cloth;
  const double longer = std::max(c.width_m, c.height_m);
  const double speed = length(c.initial_velocity_m_per_s) + length(c.spin_rad_per_s) * longer +
                       std::sqrt(2 * length(scene.gravity_m_per_s2) * longer) +
                       std::max(grip_speed_m_per_s(scene), collider_speed_m_per_s(scene));
  return std::ceil(speed * scene.time.dt() / (kMostWay * c.self_collision.thickness_m) - 1e-9);
}

}  // namespace

bool is_tethered(const Scene& scene, const nlohmann::json& settings) {
  return settings.value("tethers", true) &&
         (wants_chains(scene) ? tether_table(scene).a_vertex > 0 : !tethers_of(scene).to.empty());
}

int substeps_over_budget(const Scene& scene, const nlohmann::json& settings) {
  if (settings.value("substeps", 0) > 0 || touches_nothing(scene)) return 0;
  const double wanted = substeps_by_margins(scene, kMargins[quality_of(settings)]);
  return wanted > xpbd_substeps(scene, settings) ? static_cast<int>(std::min(wanted, 1e6)) : 0;
}

int substeps_without_gravity(const Scene& scene, const nlohmann::json& settings) {
  Scene calm = scene;
  calm.gravity_m_per_s2 = {};
  const int substeps = xpbd_substeps(calm, settings);
  return substeps < xpbd_substeps(scene, settings) ? substeps : 0;
}

double links_of_longer_side(const Cloth& c) {
  return c.mesh ? std::max(1.0, c.width_m / c.mesh->edge_m) : std::max(c.columns, c.rows) - 1;
}

int xpbd_substeps(const Scene& scene, const nlohmann::json& settings) {
  if (const int given = settings.value("substeps", 0); given > 0) return given;
  const double links = links_of_longer_side(scene.cloth);
  struct Rule {
    double least, links_a_substep;
  };
  const int k = quality_of(settings);
  const bool touched =
      !touches_nothing(scene) || !(scene.needs & FeatureSet{Feature::Pins, Feature::MovingPins}).empty();
  const bool tethered = is_tethered(scene, settings);
  const auto Y = scene.material.membrane_stiffness_N_per_m;
  const bool stiff = !Y || *Y >= 1e4;
  // Substeps are counted a frame, whatever its duration: a constant in seconds would differ between scaled copies of a
  // scene. A link must not turn by more than about half a radian a substep.
  constexpr Rule kStiff[] = {{2, 24}, {6, 12}, {20, 6}}, kTethered[] = {{3, 24}, {5, 12}, {20, 6}},
                 kStrips[] = {{5, 12}, {10, 6}, {20, 3}}, kSheet[] = {{5, 6}, {10, 3}, {20, 1.5}},
                 kDriven[] = {{5, 6}, {8, 4}, {20, 1.5}}, kLaid[] = {{8, 4}, {16, 2}, {32, 1}},
                 kLaidStrips[] = {{8, 12}, {14, 6}, {28, 3}}, kPulled[] = {{10, 6}, {20, 3}, {40, 1.5}},
                 kUntouched[] = {{3, 1e9}, {5, 1e9}, {20, 1e9}};
  const auto& grips = scene.grips.vertices;
  // A hand pushes a cloth in directions that tethers do not limit.
  const bool driven = !(scene.needs & FeatureSet{Feature::Capsules, Feature::MovingMesh}).empty();
  const bool shears = scene.needs.has(Feature::Shear), laid = !touches_nothing(scene) && grips.empty();
  const Rule rule = !touched        ? kUntouched[k]
                    : driven        ? kDriven[k]
                    : tethered      ? (stiff ? kStiff[k] : kTethered[k])
                    : laid          ? (shears ? kLaid[k] : kLaidStrips[k])
                    : !shears       ? kStrips[k]
                    : grips.empty() ? kSheet[k]
                                    : kPulled[k];
  // With few substeps the error is largest in the links at the pins, which carry more the finer the cloth is.
  const double fine = k == 0 && rule.links_a_substep == kStiff[0].links_a_substep && links > 300 ? 1.2 : 1;
  const double short_links = wants_chains(scene) ? substeps_for_short_links(scene) : 1;
  double per_frame =
      short_links * frames_for_gravity(scene) * std::max(rule.least, fine * links / rule.links_a_substep);
  if (scene.needs.has(Feature::SelfCollision)) per_frame = std::max(per_frame, substeps_for_layers(scene));
  if (const double needed = std::ceil(substeps_to_couple(scene)); needed <= most_to_couple(links) && needed > per_frame)
    if (may_couple(scene, settings).on) per_frame = needed;
  const double for_speed = substeps_for_speed(scene, k);
  return static_cast<int>(std::clamp(std::max(std::lround(per_frame), std::lround(for_speed)), 1L, 4096L));
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
