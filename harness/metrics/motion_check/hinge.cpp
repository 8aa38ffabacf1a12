// Cloth hinges on each straight line of its vertices: what the line exerts on the part beyond it has no moment about
// the line, but for the sheet's bending rigidity. So a part that nothing touches must turn as gravity turns it.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "metrics/motion_check/bodies.hpp"
#include "metrics/motion_check/motion.hpp"

namespace clothbench::motion_check {
namespace {

/// Intervals over which a moment is averaged.
constexpr std::size_t kSpans[] = {1, 3, 12};
constexpr std::size_t kKept = 12;
/// Distance from a line at which a diagonal may pass it, over the distance of two lines.
constexpr double kFlat = 0.05;

/// Lines across the cloth in one direction, from a border or a corner to the one across.
struct Lines {
  std::vector<std::vector<std::uint32_t>> vertices;
  std::vector<std::vector<std::array<std::uint32_t, 2>>> jumps;  ///< of each line: ends of the diagonals that jump it
  double spacing_m;                                              ///< of neighbouring lines at rest
};

class Hinges {
 public:
  Hinges(const Motion& m, const Bodies& b, Findings& f);
  void run();

 private:
  struct Moment {
    double value = 0, scale = 0, hidden = 0;  ///< [N m]
  };
  Moment moment(const Lines& lines, std::size_t cut, std::size_t k) const;
  void judge(std::size_t d, std::size_t k, std::size_t span);

  const Motion& m_;
  const Bodies& bodies_;
  Findings& found_;
  std::vector<Lines> lines_;
  std::vector<std::vector<std::size_t>> level_;  ///< per direction and vertex
  std::vector<std::vector<std::size_t>>
      free_from_;  ///< per direction and frame: behind all lines that are touched or held
  std::array<std::vector<V3>, kKept> force_, relative_;  ///< of the last frames: residual acceleration; velocity
  std::array<std::vector<double>, kKept> change_;        ///< size of the acceleration beyond gravity
  /// Per direction, the moments of the last frames, since spans share them.
  struct Known {
    std::size_t frame = 0, cut = 0;
    Moment moment;
  };
  std::vector<std::array<Known, kKept>> known_;
};

Hinges::Hinges(const Motion& m, const Bodies& b, Findings& f) : m_(m), bodies_(b), found_(f) {
  const Cloth& c = m.scene.cloth;
  const double du = c.du(), dv = c.dv(), slant = du * dv / std::hypot(du, dv);
  const int across = c.columns - 1, down = c.rows - 1;
  const auto add = [&](double spacing_m, auto level) {
    Lines lines{{}, {}, spacing_m};
    std::vector<std::size_t>& of = level_.emplace_back(m.vertices);
    for (std::uint32_t v = 0; v < m.vertices; ++v) {
      of[v] = static_cast<std::size_t>(level(static_cast<int>(v) % c.columns, static_cast<int>(v) / c.columns));
      if (lines.vertices.size() <= of[v]) lines.vertices.resize(of[v] + 1);
      lines.vertices[of[v]].push_back(v);
    }
    lines.jumps.resize(lines.vertices.size());
    for (std::uint32_t v = 0; v + static_cast<std::uint32_t>(c.columns) < m.vertices; ++v)
      for (const int step : {-1, 1}) {
        if (static_cast<int>(v) % c.columns + step < 0 || static_cast<int>(v) % c.columns + step > across) continue;
        const std::uint32_t w = v + static_cast<std::uint32_t>(c.columns + step);
        if (std::max(of[v], of[w]) == std::min(of[v], of[w]) + 2) lines.jumps[(of[v] + of[w]) / 2].push_back({v, w});
      }
    lines_.push_back(std::move(lines));
  };
  add(du, [&](int i, int) { return i; });
  add(du, [&](int i, int) { return across - i; });
  add(dv, [&](int, int j) { return j; });
  add(dv, [&](int, int j) { return down - j; });
  add(slant, [&](int i, int j) { return i + j; });
  add(slant, [&](int i, int j) { return across + down - i - j; });
  add(slant, [&](int i, int j) { return i + down - j; });
  add(slant, [&](int i, int j) { return across - i + j; });
  known_.resize(lines_.size());
  free_from_.assign(lines_.size(), std::vector<std::size_t>(m.frames, 0));
  for (std::size_t k = 0; k < m.frames; ++k) {
    std::vector<std::uint32_t> blocked = m.held(k);
    for (std::uint32_t v = 0; v < m.vertices; ++v)
      if (bodies_.touched(k, v)) blocked.push_back(v);
    for (std::size_t d = 0; d < lines_.size(); ++d)
      for (const std::uint32_t v : blocked) free_from_[d][k] = std::max(free_from_[d][k], level_[d][v] + 1);
  }
}

/// Of the part beyond a line about the line, in the intervals around a frame.
Hinges::Moment Hinges::moment(const Lines& lines, std::size_t cut, std::size_t k) const {
  const std::vector<std::uint32_t>& line = lines.vertices[cut];
  const std::vector<V3>&force = force_[k % kKept], &velocity = relative_[k % kKept];
  const V3 on = m_.at(k, line.front());
  V3 axis = m_.at(k, line.back()) - on, speed = V3::Zero(), net = V3::Zero();
  const double length_m = axis.norm();
  Moment out;
  if (!(length_m > 0)) return out;
  axis /= length_m;
  double bulge_m = 0;
  for (const std::uint32_t v : line) {
    bulge_m = std::max(bulge_m, (m_.at(k, v) - on).cross(axis).norm());
    speed += velocity[v] / static_cast<double>(line.size());
  }
  double jump_m = lines.jumps[cut].empty() ? 0 : bulge_m;
  for (const auto& [a, b] : lines.jumps[cut])
    jump_m = std::max(jump_m, ((m_.at(k, a) + m_.at(k, b)) / 2 - on).cross(axis).norm());
  // Diagonals that jump a bent line push and pull beside it.
  if (jump_m > kFlat * lines.spacing_m) return out;
  for (std::size_t level = cut + 1; level < lines.vertices.size(); ++level)
    for (const std::uint32_t v : lines.vertices[level]) {
      const double mass = m_.masses_kg[v];
      out.value += mass * axis.dot((m_.at(k, v) - on).cross(force[v]));
      out.hidden += mass * (velocity[v] - speed).norm() * change_[k % kKept][v];
      out.scale += mass * m_.weight_unit * lines.spacing_m * static_cast<double>(level - cut);
      net += mass * force[v];
    }
  out.hidden *= m_.dt(k) / 3;
  // A line that is not straight exerts moments by what it bulges.
  out.hidden += bulge_m * 3 * net.norm() + 2 * m_.scene.material.bending_rigidity_N_m * length_m / lines.spacing_m;
  return out;
}

void Hinges::judge(std::size_t d, std::size_t k, std::size_t span) {
  if (k < span) return;
  std::size_t cut = 0;
  for (std::size_t f = k - span; f <= k + 1; ++f) cut = std::max(cut, free_from_[d][f]);
  const Lines& lines = lines_[d];
  if (cut == 0) cut = lines.vertices.size() / 2;
  if (cut + 3 >= lines.vertices.size() || lines.vertices[cut].size() < 2) return;
  if (cut + 4 >= lines.vertices.size() && !lines.jumps[cut].empty()) return;
  double value = 0, hidden = 0, scale = 0;
  for (std::size_t f = k + 1 - span; f <= k; ++f) {
    Known& known = known_[d][f % kKept];
    if (known.frame != f || known.cut != cut) known = {f, cut, moment(lines, cut, f)};
    const Moment& now = known.moment;
    if (!(now.scale > 0)) return;
    value += now.value, hidden += now.hidden, scale += now.scale;
  }
  std::size_t beyond = 0;
  for (std::size_t level = cut + 1; level < lines.vertices.size(); ++level) beyond += lines.vertices[level].size();
  const double off = std::max(0.0, std::abs(value) - hidden) / scale, n = static_cast<double>(span);
  const double allowed = (span == 1 ? 0.5 : 0.05) + 1.5 * m_.noise(k, beyond) / n;
  found_.add("hinge", off / allowed, k);
}

void Hinges::run() {
  for (std::size_t k = 1; k + 1 < m_.frames; ++k) {
    const double before = m_.dt(k), after = m_.dt(k + 1);
    const Flight flight(before, after, m_.scene.material.damping_per_s);
    std::vector<V3>&force = force_[k % kKept], &velocity = relative_[k % kKept];
    std::vector<double>& change = change_[k % kKept];
    force.resize(m_.vertices), velocity.resize(m_.vertices), change.resize(m_.vertices);
    for (std::size_t v = 0; v < m_.vertices; ++v) {
      const V3 behind = m_.at(k, v) - m_.at(k - 1, v), ahead = m_.at(k + 1, v) - m_.at(k, v);
      force[v] = flight.unexplained(behind, ahead, m_.gravity);
      velocity[v] = (ahead + behind) / (before + after);
      change[v] = force[v].norm();
    }
    for (std::size_t d = 0; d < lines_.size(); ++d)
      for (const std::size_t span : kSpans)
        if (span < 12 || k % 6 == 0) judge(d, k, span);
  }
}

}  // namespace

void check_hinges(const Motion& m, Bodies& bodies, Findings& found) {
  // Layers in contact exert forces on each other that positions do not tell.
  if (m.scene.cloth.mesh || m.scene.cloth.self_collision.thickness_m > 0) return;
  found.define("hinge");
  Hinges(m, bodies, found).run();
}

}  // namespace clothbench::motion_check
