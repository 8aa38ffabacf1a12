// Cloth bends freely about a straight line across it: links that cross the line pull at points on it, so only bending
// rigidity exerts a moment about it. Gravity must explain how a free part beyond the line rotates.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "metrics/motion_check/motion.hpp"

namespace clothbench::motion_check {
namespace {

/// Numbers of intervals over which a moment is averaged.
constexpr std::size_t kSpans[] = {1, 3, 12};
constexpr std::size_t kKept = 12;
/// Minimum depth of the part beyond a line, in cells.
constexpr double kDeep = 2.8;
/// If links cross a line between vertices: maximum offset of a crossing, in cells; minimum vertices beyond the line.
constexpr double kFlat = 0.1;
constexpr std::size_t kMany = 20;
/// If a line is not straight, forces act at most this many times the bulge away from it.
constexpr double kBulge = 6;

/// A point of the grid: column and row.
using Place = std::array<int, 2>;
/// All grid points with p i + q j = c; for the part beyond the line, p i + q j > c.
struct Line {
  int p, q, c;
  int level(const Place& at) const { return p * at[0] + q * at[1]; }
  auto operator<=>(const Line&) const = default;
};

/// Corners of the convex hull, anticlockwise (Andrew 1979).
std::vector<Place> hull_of(std::vector<Place> all) {
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  if (all.size() < 3) return all;
  std::vector<Place> out;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = out.size();
    for (const Place& c : all) {
      while (out.size() >= first + 2) {
        const Place &a = out[out.size() - 2], &b = out.back();
        if ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0) break;
        out.pop_back();
      }
      out.push_back(c);
    }
    out.pop_back();
    std::reverse(all.begin(), all.end());
  }
  return out;
}

class Hinges {
 public:
  Hinges(const Motion& m, const Bodies& b, Findings& f) : m_(m), found_(f), blocked_(m.frames) {
    for (int v = 0; v < static_cast<int>(m.vertices); ++v)
      place_.push_back({v % m.scene.cloth.columns, v / m.scene.cloth.columns});
    for (std::size_t k = 0; k < m.frames; ++k) {
      for (const std::uint32_t v : m.held(k)) blocked_[k].push_back(place_[v]);
      for (std::size_t v = 0; v < m.vertices; ++v)
        if (b.touched(k, v)) blocked_[k].push_back(place_[v]);
      blocked_[k] = hull_of(std::move(blocked_[k]));
    }
  }

  void run() {
    for (std::size_t k = 1; k + 1 < m_.frames; ++k) {
      const double before = m_.dt(k), after = m_.dt(k + 1);
      const Flight flight(before, after, m_.scene.material.damping_per_s);
      std::vector<V3>&force = force_[k % kKept], &velocity = relative_[k % kKept];
      force.resize(m_.vertices), velocity.resize(m_.vertices);
      known_[k % kKept].clear();
      for (std::size_t v = 0; v < m_.vertices; ++v) {
        const V3 behind = m_.at(k, v) - m_.at(k - 1, v), ahead = m_.at(k + 1, v) - m_.at(k, v);
        force[v] = flight.unexplained(behind, ahead, m_.gravity);
        velocity[v] = (ahead + behind) / (before + after);
      }
      for (const std::size_t span : kSpans) {
        if (k < span || (span == kKept && k % 6 != 0)) continue;
        std::vector<Place> blocked;
        for (std::size_t f = k - span; f <= k + 1; ++f)
          blocked.insert(blocked.end(), blocked_[f].begin(), blocked_[f].end());
        for (const Line& line : lines_of(hull_of(std::move(blocked)))) judge(line, k, span);
      }
    }
  }

 private:
  struct Moment {
    double value = 0, scale = 0, hidden = 0;  ///< [N m]
    std::size_t beyond = 0;                   ///< vertices of the part
  };
  /// Lines along rows, columns, diagonals and hull edges, at the border of the hull `blocked` or, if empty, the centre.
  std::vector<Line> lines_of(const std::vector<Place>& blocked) const {
    const Place last = place_.back();
    std::vector<Line> out;
    const auto add = [&](int p, int q) {
      Line line{p, q, (p * last[0] + q * last[1]) / 2};
      if (!blocked.empty()) line.c = line.level(blocked.front());
      for (const Place& at : blocked) line.c = std::max(line.c, line.level(at));
      const int deepest = std::max(p, 0) * last[0] + std::max(q, 0) * last[1] - line.c;
      if (deepest * spacing_m(line) > kDeep * m_.cell_m) out.push_back(line);
    };
    for (int p = -1; p <= 1; ++p)
      for (int q = -1; q <= 1; ++q)
        if (p != 0 || q != 0) add(p, q);
    for (std::size_t i = 0; blocked.size() > 1 && i < blocked.size(); ++i) {
      const Place &a = blocked[i], &b = blocked[(i + 1) % blocked.size()];
      const int du = b[0] - a[0], dv = b[1] - a[1], common = std::gcd(du, dv);
      if (std::max(std::abs(du), std::abs(dv)) > common) add(dv / common, -du / common);
    }
    return out;
  }

  /// Points of the sheet on a line: first its vertices, in order along the line, then points on links that cross it.
  std::vector<V3> crossings(const Line& line, std::size_t k, std::size_t& vertices) const {
    std::vector<std::pair<int, V3>> on;
    std::vector<V3> links;
    const Place last = place_.back();
    for (std::size_t v = 0; v < m_.vertices; ++v) {
      const Place& at = place_[v];
      const int beyond = line.level(at) - line.c;
      if (beyond == 0) on.emplace_back(line.p * at[1] - line.q * at[0], m_.at(k, v));
      if (std::abs(beyond) >= std::abs(line.p) + std::abs(line.q)) continue;
      for (const Place& step : {Place{1, 0}, Place{0, 1}, Place{1, 1}, Place{-1, 1}}) {
        const int other = beyond + line.p * step[0] + line.q * step[1];
        if (beyond * other >= 0 || at[0] + step[0] < 0 || at[0] + step[0] > last[0] || at[1] + step[1] > last[1])
          continue;
        const double share = static_cast<double>(beyond) / (beyond - other);
        const std::size_t w = v + static_cast<std::size_t>(step[1] * m_.scene.cloth.columns + step[0]);
        links.push_back((1 - share) * m_.at(k, v) + share * m_.at(k, w));
      }
    }
    std::sort(on.begin(), on.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    vertices = on.size();
    std::vector<V3> out;
    for (const auto& [along, x] : on) out.push_back(x);
    out.insert(out.end(), links.begin(), links.end());
    return out;
  }

  /// Moment about a line of the forces on the part beyond it, in the two intervals around a frame.
  Moment moment(const Line& line, std::size_t k) const {
    const std::vector<V3>&force = force_[k % kKept], &velocity = relative_[k % kKept];
    std::size_t vertices = 0;
    const std::vector<V3> on = crossings(line, k, vertices);
    Moment out;
    if (vertices < 2) return out;
    V3 axis = on[vertices - 1] - on[0], speed = V3::Zero();
    const double length_m = axis.norm();
    if (!(length_m > 0)) return out;
    axis /= length_m;
    double bulge_m = 0, net = 0;
    for (const V3& x : on) bulge_m = std::max(bulge_m, (x - on[0]).cross(axis).norm());
    for (std::size_t v = 0; v < m_.vertices; ++v)
      if (line.level(place_[v]) == line.c) speed += velocity[v] / static_cast<double>(vertices);
    for (std::size_t v = 0; v < m_.vertices; ++v) {
      const int beyond = line.level(place_[v]) - line.c;
      if (beyond <= 0) continue;
      const double mass = m_.masses_kg[v], size = force[v].norm();
      out.value += mass * axis.dot((m_.at(k, v) - on[0]).cross(force[v]));
      out.hidden += mass * (velocity[v] - speed).norm() * size;
      out.scale += mass * m_.weight_unit * spacing_m(line) * beyond;
      net += mass * size;
      ++out.beyond;
    }
    // A curved sheet is stiff in bending, and a corner moves like a whip; neither is evaluated.
    if (on.size() > vertices && (bulge_m > kFlat * m_.cell_m || out.beyond < kMany)) return {};
    out.hidden *= m_.dt(k) / 3;
    // If the line is not straight, links exert moments with its bulge as lever arm.
    out.hidden += kBulge * bulge_m * net + 3 * m_.scene.material.bending_rigidity_N_m * length_m / m_.cell_m;
    return out;
  }

  void judge(const Line& line, std::size_t k, std::size_t span) {
    Moment sum;
    std::vector<double> each;
    for (std::size_t f = k + 1 - span; f <= k; ++f) {
      const auto [known, fresh] = known_[f % kKept].try_emplace(line);
      if (fresh) known->second = moment(line, f);
      const Moment& now = known->second;
      if (!(now.scale > 0)) return;
      each.push_back(std::max(0.0, std::abs(now.value) - now.hidden) / now.scale);
      sum.value += now.value, sum.hidden += now.hidden, sum.scale += now.scale, sum.beyond = now.beyond;
    }
    double off = std::max(0.0, std::abs(sum.value) - sum.hidden) / sum.scale;
    if (span == 3) {  // an impact may fall into one of three intervals
      std::sort(each.begin(), each.end());
      off = std::min(off, each[1]);
    }
    const double allowed = (span == 1 ? 0.5 : 0.05) + 1.5 * m_.noise(k, sum.beyond) / static_cast<double>(span);
    found_.add("hinge", off / allowed, k);
  }

  /// Distance between the parallel lines c and c + 1.
  double spacing_m(const Line& line) const {
    return 1 / std::hypot(line.p / m_.scene.cloth.du(), line.q / m_.scene.cloth.dv());
  }
  const Motion& m_;
  Findings& found_;
  std::vector<Place> place_;                             ///< of each vertex
  std::vector<std::vector<Place>> blocked_;              ///< per frame: hull of the vertices that are touched or held
  std::array<std::vector<V3>, kKept> force_, relative_;  ///< of the last frames: residual acceleration; velocity
  std::array<std::map<Line, Moment>, kKept> known_;      ///< of the last frames; spans share moments
};

}  // namespace

void check_hinges(const Motion& m, Bodies& bodies, Findings& found) {
  // Positions do not reveal the forces between layers in contact.
  if (m.scene.cloth.mesh || m.scene.cloth.self_collision.thickness_m > 0) return;
  found.define("hinge");
  Hinges(m, bodies, found).run();
}

}  // namespace clothbench::motion_check
