// Displacements that nothing explains.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "clothbench/motion.hpp"
#include "clothbench/vector.hpp"
#include "metrics/registry.hpp"

namespace clothbench {
namespace {

/// Within some 30 ms the eye sums what it sees (Barlow 1958, by daylight): a viewer sees a jump there, not a motion.
/// Whole frames, and two of them, since a snap that is shorter than a frame may begin before a frame and end after it.
double window_s(const Scene& scene) {
  constexpr double kRounding = 1e-9;
  return std::max(2.0, std::ceil(1.0 / 36 / scene.time.dt() - kRounding)) * scene.time.dt();
}

// A body that is hit leaves at up to twice the speed of what hits it, and a wave that arrives at a free edge moves that
// edge at twice its own.
constexpr double kDoubled = 2;

/// A time within a run: `share` of the way from frame `before` to the next.
struct Moment {
  std::size_t before;
  double share;
};

Moment moment(const std::vector<double>& time_s, double t) {
  const auto next = std::upper_bound(time_s.begin() + 1, time_s.end() - 1, t) - time_s.begin();
  const auto before = static_cast<std::size_t>(next) - 1;
  return {before, (t - time_s[before]) / (time_s[before + 1] - time_s[before])};
}

/// Positions [m] of all vertices at a time; until the start they move at their initial velocities.
std::vector<Vec3> positions_at(const RunView& r, double t) {
  const std::size_t vertices = r.scene.cloth.vertex_count();
  std::vector<Vec3> x(vertices);
  if (t < r.pass.time_s[0]) {
    const std::vector<double> velocity = initial_velocities(r.scene);
    for (std::size_t v = 0; v < vertices; ++v)
      x[v] = plus(vertex_at(r.pass.position, v), scaled(t - r.pass.time_s[0], vertex_at(velocity, v)));
    return x;
  }
  const Moment m = moment(r.pass.time_s, t);
  for (std::size_t v = 0; v < vertices; ++v)
    x[v] = plus(scaled(1 - m.share, vertex_at(r.pass.position, m.before * vertices + v)),
                scaled(m.share, vertex_at(r.pass.position, (m.before + 1) * vertices + v)));
  return x;
}

/// Distance [m] that the fastest collider or grip has gone by the end of each frame.
std::vector<double> driven_m(const RunView& r) {
  const std::vector<double> speeds = driving_speeds_m_per_s(r.scene);
  std::vector<double> way(r.pass.time_s.size(), 0);
  for (std::size_t f = 1; f < way.size(); ++f)
    way[f] = way[f - 1] + (f < speeds.size() ? speeds[f] * r.scene.time.dt_after(static_cast<int>(f) - 1) : 0);
  return way;
}

/// The vertices up to two edges away from each, without itself: a fold is at least this wide.
std::vector<std::vector<std::uint32_t>> neighbours(const Cloth& cloth) {
  std::vector<std::set<std::uint32_t>> beside(cloth.vertex_count());
  for (const auto& t : triangles(cloth))
    for (const std::uint32_t v : t) beside[v].insert(t.begin(), t.end());
  std::vector<std::vector<std::uint32_t>> out;
  for (std::uint32_t v = 0; v < beside.size(); ++v) {
    std::set<std::uint32_t> near;
    for (const std::uint32_t w : beside[v]) near.insert(beside[w].begin(), beside[w].end());
    near.erase(v);
    out.emplace_back(near.begin(), near.end());
  }
  return out;
}

/// The greatest displacement in the second of three windows beyond the explained one: twice the displacement of what
/// drives the cloth in any of them, twice the neighbours' in the first or third, and twice the vertex's own in these,
/// as far as it has the same direction. `x` has the positions at the windows' ends.
double unexplained_m(const std::array<std::vector<Vec3>, 4>& x, double driven_m,
                     const std::vector<std::vector<std::uint32_t>>& near) {
  const auto way = [&](std::size_t window, std::size_t v) { return minus(x[window + 1][v], x[window][v]); };
  std::vector<double> beside(near.size());
  for (std::size_t v = 0; v < near.size(); ++v) beside[v] = std::max(length(way(0, v)), length(way(2, v)));
  double most = 0;
  for (std::size_t v = 0; v < near.size(); ++v) {
    const Vec3 now = way(1, v);
    const double moved = length(now);
    double explained = std::max(driven_m, moved > 0 ? std::max(dot(now, way(0, v)), dot(now, way(2, v))) / moved : 0);
    for (const std::uint32_t other : near[v]) explained = std::max(explained, beside[other]);
    most = std::max(most, moved - kDoubled * explained);
  }
  return most;
}

double pop(const RunView& r) {
  constexpr double kRounding_s = 1e-9;
  const std::vector<double>& time = r.pass.time_s;
  const std::vector<float>& position = r.pass.position;
  if (position.empty() || !std::all_of(position.begin(), position.end(), [](float x) { return std::isfinite(x); }))
    return kMissing;
  const double window = window_s(r.scene);
  const std::vector<double> driven = driven_m(r);
  const auto driven_by = [&](double t) {
    const Moment m = moment(time, std::max(t, time[0]));
    return (1 - m.share) * driven[m.before] + m.share * driven[m.before + 1];
  };
  const auto near = neighbours(r.scene.cloth);
  double most = 0;
  for (std::size_t half = 0; half < 2 * time.size() - 1; ++half) {  // from every frame and from midway to the next
    const double start = (time[half / 2] + time[(half + 1) / 2]) / 2;
    if (start + 2 * window > time.back() + kRounding_s) break;
    std::array<std::vector<Vec3>, 4> x;
    double by = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const double t = start + (static_cast<double>(k) - 1) * window;
      x[k] = positions_at(r, t);
      if (k > 0) by = std::max(by, driven_by(t) - driven_by(t - window));
    }
    most = std::max(most, unexplained_m(x, by, near));
  }
  return most;
}

}  // namespace

MetricGroup popping_metrics() {
  static constexpr Gate kHalf{0.005, SlackUnit::Length, 0.25, false, "half of the strict bound on a cloth of 1 m"};
  return {{},
          {{"pop_max_m",
            own({},
                "maximum displacement of a vertex within 1/36 s, minus twice the displacement of its neighbours, "
                "colliders and "
                "attachments",
                pop, "m"),
            Expect::Yes, &kHalf}}};
}

}  // namespace clothbench
