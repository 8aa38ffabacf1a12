// The cloth after contact: popping off the collider that swept it, jitter and creep at rest.
#include <algorithm>
#include <cmath>

#include "clothbench/motion.hpp"
#include "clothbench/vector.hpp"
#include "metrics/reduction.hpp"

namespace clothbench {
namespace {

/// Distance [m] of vertex v between two stored frames.
double moved(const AccuracyPass& pass, std::size_t vertices, std::size_t v, std::size_t from, std::size_t to) {
  return length(minus(vertex_at(pass.position, to * vertices + v), vertex_at(pass.position, from * vertices + v)));
}

/// Displacement and speed of the cloth after a moving collider has left it (the paper's Fig. 8).
struct Popping {
  double way_m = kMissing, speed_m_per_s = kMissing;
  double limit_m_per_s = kMissing;  ///< greatest plausible speed
};

/// The first frame after the last contact, or 0 if the cloth was not released. A cloth that swings back onto a static
/// hand is no longer swept by it: the contact that counts is the last one that began before the hand stopped.
std::size_t let_go(const std::vector<double>& touching, const std::vector<double>& speeds, double fastest) {
  const auto rests = [&](std::size_t frame) {  // static up to rounding, before and after the frame
    return speeds[frame] <= 1e-6 * fastest && (frame + 1 == speeds.size() || speeds[frame + 1] <= 1e-6 * fastest);
  };
  std::size_t end = std::min(touching.size(), speeds.size());
  while (end > 0 && (touching[end - 1] == 0 || rests(end - 1))) --end;
  if (end > 0)
    while (end < touching.size() && touching[end] != 0) ++end;
  return end == touching.size() ? 0 : end;
}

Popping popping(const RunView& r) {
  constexpr std::size_t kPopFrames = 3;
  // What is left inside a margin snaps out at once. Later a free corner may crack like a whip, which is no popping: its
  // wave first crosses the cloth.
  constexpr double kPopSeconds = 0.1;
  const Scene& scene = r.scene;
  const std::vector<double>*touching = r.series("touching_fraction"), *speed = r.series("speed_max");
  const bool moves =
      std::any_of(scene.colliders.begin(), scene.colliders.end(), [](const Collider& c) { return c.moves(); });
  if (!moves || touching == nullptr || speed == nullptr || !std::isfinite(greatest_of(touching))) return {};
  const std::vector<double> speeds = collider_speeds_m_per_s(scene);
  const double fastest = speeds.empty() ? 0 : *std::max_element(speeds.begin(), speeds.end());
  const std::size_t from = let_go(*touching, speeds, fastest), vertices = scene.cloth.vertex_count();
  const bool never_touched = r.whole() && greatest_of(touching) == 0;
  if (from == 0 && !never_touched) return {};
  Popping out;
  out.way_m = 0;
  for (std::size_t f = from; !never_touched && f < std::min(from + kPopFrames, r.pass.time_s.size()); ++f)
    for (std::size_t v = 0; v < vertices; ++v)
      out.way_m = max_or_nan(out.way_m, moved(r.pass, vertices, v, from - 1, f));
  out.speed_m_per_s = 0;
  for (std::size_t f = from; !never_touched && f < std::min(speed->size(), r.pass.time_s.size()); ++f)
    if (f == from || r.pass.time_s[f] - r.pass.time_s[from - 1] <= kPopSeconds + 1e-9)
      out.speed_m_per_s = max_or_nan(out.speed_m_per_s, (*speed)[f]);
  // Cloth that is hit moves at up to twice the collider's speed (as off a bat); falling cloth falls at most its own
  // length.
  const double fall =
      std::sqrt(2 * length(scene.gravity_m_per_s2) * std::max(scene.cloth.width_m, scene.cloth.height_m));
  out.limit_m_per_s = std::max(2 * fastest, fall);
  return out;
}

double pop_speed_ratio(const RunView& r) {
  const Popping p = popping(r);
  return p.limit_m_per_s > 0 ? p.speed_m_per_s / p.limit_m_per_s : kMissing;
}

/// Whether the last half second has at least three frames, for a cloth that may rest on a collider.
bool rests_long_enough(const RunView& r) {
  return !r.scene.colliders.empty() && r.whole() && r.pass.time_s.size() - r.settled_from() >= 3;
}

/// Second differences of positions: a steady drift does not contribute.
double rest_jitter(const RunView& r) {
  if (!rests_long_enough(r)) return kMissing;
  const std::size_t vertices = r.scene.cloth.vertex_count(), frames = r.pass.time_s.size(), from = r.settled_from();
  double jitter = 0;
  for (std::size_t v = 0; v < vertices; ++v)
    for (std::size_t f = from + 1; f + 1 < frames; ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto at = [&](std::size_t frame) {
          return static_cast<double>(r.pass.position[3 * (frame * vertices + v) + k]);
        };
        const double bend = (at(f + 1) - 2 * at(f) + at(f - 1)) / 2;
        jitter += bend * bend;
      }
  return std::sqrt(jitter / (static_cast<double>(vertices) * static_cast<double>(frames - from - 2)));
}

double rest_drift(const RunView& r) {
  if (!rests_long_enough(r)) return kMissing;
  const std::size_t vertices = r.scene.cloth.vertex_count(), end = r.pass.time_s.size() - 1, from = r.settled_from();
  double drift = 0;
  for (std::size_t v = 0; v < vertices; ++v) {
    const double way = moved(r.pass, vertices, v, from, end);
    drift += way * way;
  }
  return std::sqrt(drift / static_cast<double>(vertices)) / (r.pass.time_s.back() - r.pass.time_s[from]);
}

}  // namespace

MetricGroup popping_metrics() {
  using enum Expect;
  static constexpr Gate kFastest{0.1, SlackUnit::One, 0.25, false, "the fastest vertex of a moment"};
  return {
      {},
      {{"pop_displacement_m",
        own(
            {"touching_fraction"},
            "greatest displacement of a vertex within three frames after the last contact with a collider that moves",
            [](const RunView& r) { return popping(r).way_m; }, "m"),
        Yes, nullptr, 220},
       {"pop_speed_m_per_s",
        own(
            {"touching_fraction", "speed_max"},
            "greatest speed within 0.1 s after the last contact with a collider that moves",
            [](const RunView& r) { return popping(r).speed_m_per_s; }, "m s-1"),
        No, nullptr, 230},
       {"pop_speed_ratio",
        own({"touching_fraction", "speed_max"},
            "greatest speed within 0.1 s after the last contact with a collider that moves, over twice the collider's "
            "or that of a fall of the cloth's length, whichever is more",
            pop_speed_ratio, "1"),
        Yes, &kFastest, 240},
       {"rest_jitter_m",
        own({}, "root mean square of half the second differences of the positions over the last 0.5 s", rest_jitter,
            "m"),
        Yes, nullptr, 270},
       {"rest_drift_m_per_s", own({}, "root mean square speed of creep over the last 0.5 s", rest_drift, "m s-1"), Yes,
        nullptr, 280}}};
}

}  // namespace clothbench
