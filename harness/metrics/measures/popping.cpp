// Displacements that no driver, neighbour or own motion explains.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "metrics/registry.hpp"

namespace clothbench {
namespace {

/// The eye sums light over about 30 ms (Barlow 1958, daylight), so a motion within this time looks like a jump. The
/// window has at least two whole frames, because a snap shorter than a frame's duration may straddle a frame.
double window_s(const Scene& scene) {
  constexpr double kRounding = 1e-9;
  return std::max(2.0, std::ceil(1.0 / 36 / scene.time.dt() - kRounding)) * scene.time.dt();
}

// A body that is hit leaves at up to twice the speed of the body that hits it. A wave moves a free edge twice as fast
// as the vertices inside, because wave and reflection add up. At a corner, two edges reflect the wave.
constexpr double kDoubled = 2, kAtCorner = 4;

/// A time within a run: `share` is the fraction of the interval from frame `before` to the next.
struct Moment {
  std::size_t before;
  double share;
};

Moment moment(const std::vector<double>& time_s, double t) {
  const auto next = std::upper_bound(time_s.begin() + 1, time_s.end() - 1, t) - time_s.begin();
  const auto before = static_cast<std::size_t>(next) - 1;
  return {before, (t - time_s[before]) / (time_s[before + 1] - time_s[before])};
}

/// All vertices at one time.
struct Instant {
  std::vector<Vec3> position_m;
  std::vector<double> path_m;  ///< length of the path since the first frame, negative before it
};

/// The motion of a run, interpolated between frames. Before the start all vertices move at their initial velocities.
class Paths {
 public:
  explicit Paths(const RunView& r) : run_(r), vertices_(r.scene.cloth.vertex_count()), path_m_(vertices_, 0) {
    for (std::size_t v = vertices_; v < vertices_ * r.pass.time_s.size(); ++v)
      path_m_.push_back(path_m_[v - vertices_] + length(minus(at(v), at(v - vertices_))));
  }

  Instant at_time(double t) const {
    Instant out{std::vector<Vec3>(vertices_), std::vector<double>(vertices_)};
    const std::vector<double>& time_s = run_.pass.time_s;
    if (t < time_s[0]) {
      const std::vector<double> velocity = initial_velocities(run_.scene);
      for (std::size_t v = 0; v < vertices_; ++v) {
        out.position_m[v] = plus(at(v), scaled(t - time_s[0], vertex_at(velocity, v)));
        out.path_m[v] = (t - time_s[0]) * length(vertex_at(velocity, v));
      }
      return out;
    }
    const Moment m = moment(time_s, t);
    for (std::size_t v = 0; v < vertices_; ++v) {
      const std::size_t before = m.before * vertices_ + v, next = before + vertices_;
      out.position_m[v] = plus(scaled(1 - m.share, at(before)), scaled(m.share, at(next)));
      out.path_m[v] = (1 - m.share) * path_m_[before] + m.share * path_m_[next];
    }
    return out;
  }

 private:
  Vec3 at(std::size_t k) const { return vertex_at(run_.pass.position, k); }

  const RunView& run_;
  std::size_t vertices_;
  std::vector<double> path_m_;  ///< path of every vertex in every frame
};

/// Path length [m] up to each frame's end: the sum of the displacements of the fastest collider or grip in each frame.
std::vector<double> driven_m(const RunView& r) {
  const std::vector<double> speeds = driving_speeds_m_per_s(r.scene);
  std::vector<double> way(r.pass.time_s.size(), 0);
  for (std::size_t f = 1; f < way.size(); ++f)
    way[f] = way[f - 1] + (f < speeds.size() ? speeds[f] * r.scene.time.dt_after(static_cast<int>(f) - 1) : 0);
  return way;
}

/// Neighbours that can move a vertex.
struct Surroundings {
  std::vector<std::uint32_t> near;  ///< vertices up to two edges away, without itself: folds are at least this wide
  double gain;                      ///< largest ratio of the vertex's speed to its neighbours' speeds
};

std::vector<Surroundings> surroundings(const Cloth& cloth) {
  std::vector<std::set<std::uint32_t>> beside(cloth.vertex_count());
  std::vector<int> triangles_at(beside.size(), 0);
  for (const auto& t : triangles(cloth))
    for (const std::uint32_t v : t) beside[v].insert(t.begin(), t.end()), ++triangles_at[v];
  std::vector<Surroundings> out;
  for (std::uint32_t v = 0; v < beside.size(); ++v) {
    std::set<std::uint32_t> near;
    for (const std::uint32_t w : beside[v]) near.insert(beside[w].begin(), beside[w].end());
    near.erase(v);
    const bool corner = triangles_at[v] <= 2;
    out.push_back({{near.begin(), near.end()}, corner ? kAtCorner : kDoubled});
  }
  return out;
}

/// Maximum displacement in the second of three windows beyond the explained part, which is the largest of: twice the
/// path of any driver in any window; twice the vertex's displacement in the first or third window in the same
/// direction; a neighbour's path in these two windows times the vertex's gain. `x`: states at the ends of the windows.
double unexplained_m(const std::array<Instant, 4>& x, double driven_m, const std::vector<Surroundings>& round) {
  const auto displacement = [&](std::size_t window, std::size_t v) {
    return minus(x[window + 1].position_m[v], x[window].position_m[v]);
  };
  const auto path = [&](std::size_t window, std::size_t v) { return x[window + 1].path_m[v] - x[window].path_m[v]; };
  std::vector<double> beside(round.size());
  for (std::size_t v = 0; v < round.size(); ++v) beside[v] = std::max(path(0, v), path(2, v));
  double most = 0;
  for (std::size_t v = 0; v < round.size(); ++v) {
    const Vec3 now = displacement(1, v);
    const double moved = length(now);
    const double own = moved > 0 ? std::max(dot(now, displacement(0, v)), dot(now, displacement(2, v))) / moved : 0;
    double explained = kDoubled * std::max(driven_m, own);
    for (const std::uint32_t other : round[v].near) explained = std::max(explained, round[v].gain * beside[other]);
    most = std::max(most, moved - explained);
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
  const Paths paths(r);
  const std::vector<Surroundings> round = surroundings(r.scene.cloth);
  double most = 0;
  for (std::size_t half = 0; half < 2 * time.size() - 1; ++half) {  // windows start at frames and midway
    const double start = (time[half / 2] + time[(half + 1) / 2]) / 2;
    if (start + 2 * window > time.back() + kRounding_s) break;
    std::array<Instant, 4> x;
    double by = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const double t = start + (static_cast<double>(k) - 1) * window;
      x[k] = paths.at_time(t);
      if (k > 0) by = std::max(by, driven_by(t) - driven_by(t - window));
    }
    most = std::max(most, unexplained_m(x, by, round));
  }
  return most;
}

}  // namespace

MetricGroup popping_metrics() {
  static constexpr Gate kFifth{0.005, SlackUnit::Length, 0.25, false, "a fifth of the strict bound on a cloth of 1 m"};
  return {{},
          {{"pop_max_m",
            own({},
                "maximum displacement of a vertex within 1/36 s that its neighbours, colliders and attachments do not "
                "explain",
                pop, "m"),
            Expect::Yes, &kFifth}}};
}

}  // namespace clothbench
