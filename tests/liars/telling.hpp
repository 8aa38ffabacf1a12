#pragma once
// Ingredients of lies: a right motion at other places, at other moments.
#include <algorithm>
#include <cmath>

#include "lies.hpp"

namespace clothbench::liars {

using Told = std::optional<Motion>;
using Index = std::size_t;

inline V3 v3(const Vec3& x) { return V3::Map(x.data()); }
inline Vec3 vec(const V3& x) { return {x[0], x[1], x[2]}; }

inline V3 direction(Dice& dice) {
  const auto rows = dice.rotation();
  return v3(rows[0]);
}

/// A direction across `up`.
inline V3 level(const V3& up, Dice& dice) {
  for (;;) {
    const V3 d = direction(dice), across = d - d.dot(up) * up;
    if (across.norm() > 0.3) return across.normalized();
  }
}

/// 0 up to frame `from`, then smoothly up to 1 within `frames`.
inline double faded(Index k, Index from, double frames) {
  const double x = std::min(static_cast<double>(std::max(k, from) - from) / frames, 1.0);
  return x * x * (3 - 2 * x);
}

/// A frame well inside a range.
inline Index between(Index first, Index last, Dice& dice) {
  if (last <= first) return first;
  return first + static_cast<Index>(dice.whole(0, static_cast<int>(last - first)));
}

/// A frame of the motion with something going on, not among the first or last few.
inline Index amid(const Right& r, Dice& dice) {
  const Index n = r.motion.frames(), end = std::min(n - 5, std::max<Index>(r.facts.at_rest, 12));
  return std::clamp<Index>(between(6, std::max<Index>(7, end * 3 / 4), dice), 4, n - 5);
}

/// The right motion with the vertices that are not held moved.
template <class Move>
Motion moved(const Right& r, Move move) {
  Motion out = r.motion;
  for (Index k = 0; k < out.frames(); ++k)
    for (Index v = 0; v < out.vertices(); ++v)
      if (!r.held(k, v)) out.put(k, v, vec(V3(move(k, v, v3(r.motion.at(k, v))))));
  return out;
}

/// The right motion at other moments: frame k shows the moment of frame `moment(k)`, which may be a fraction.
template <class Moment>
Motion retimed(const Right& r, Moment moment) {
  const double last = static_cast<double>(r.motion.frames() - 1);
  return moved(r, [&](Index k, Index v, const V3&) -> V3 {
    const double at = std::clamp(moment(static_cast<double>(k)), 0.0, last);
    const Index below = std::min(static_cast<Index>(at), r.motion.frames() - 2);
    const double share = at - static_cast<double>(below);
    return (1 - share) * v3(r.motion.at(below, v)) + share * v3(r.motion.at(below + 1, v));
  });
}

/// Vertices that may be told lies of in any frame.
inline std::vector<Index> loose(const Right& r) {
  std::vector<Index> out;
  for (Index v = 0; v < r.motion.vertices(); ++v)
    if (!r.held(0, v)) out.push_back(v);
  return out;
}

// To which scenes a lie applies, and whether positions determine it.

inline bool always(const Facts&) { return true; }
inline bool surely(const Right&, const Motion&) { return true; }
inline bool never(const Right&, const Motion&) { return false; }
/// Positions tell a lie about forces if attachments leave an equation and it changes them beyond a tolerance.
inline bool judged(const Right& r, const Motion& told) { return r.facts.equations > 0 && changes_force(r, told); }
inline bool stiff(const Right& r, const Motion&) { return r.facts.soft_strain < 0.05; }
/// Where normals differ, a force without friction may be one with friction on other vertices.
inline bool drags(const Right& r, const Motion& told) { return r.facts.slides && judged(r, told); }
inline bool attached(const Facts& f) { return f.attached; }
inline bool flies(const Facts& f) { return !f.air.empty(); }
inline bool drops(const Facts& f) { return f.falls && !f.attached && f.collider; }
inline bool lies_still(const Facts& f) { return drops(f) && f.at_rest + 24 < f.frames; }
inline bool has_kinematic(const Facts& f) { return f.kinematic && f.deepest_touch < f.frames; }
/// A vertex off in one frame looks like an impact unless it moves by more than vertices are accelerated around it.
template <int Millimetres>
inline bool beyond_impact(const Right& r, const Motion& told) {
  const Facts& f = r.facts;
  const double floor_m = 1.5 * (20e-4 * f.length_m + 0.75 * f.gravity * f.frame_s * f.frame_s),
               by_m = 1e-3 * Millimetres;
  return by_m > 1.5 * floor_m && by_m > 3 * accelerated_m(r.motion, first_difference(r, told));
}
/// A patch stands still in the air while it and the cloth move.
inline bool hangs_still(const Right& r, const Motion& told) {
  const Facts& f = r.facts;
  const Index k = first_difference(r, told);
  if (std::find(f.air.begin(), f.air.end(), k) == f.air.end()) return false;
  const double moving_m = f.gravity * f.frame_s * f.frame_s + 4e-4 * f.length_m;
  Index stopped = 0, move = 0;
  for (Index v = 0; v < told.vertices(); ++v) {
    const bool moved = (v3(r.motion.at(k, v)) - v3(r.motion.at(k - 1, v))).norm() > moving_m;
    move += moved;
    stopped += moved && told.at(k, v) == told.at(k - 1, v);
  }
  return stopped > 3 && 2 * move > told.vertices() + 2 * stopped;
}
/// Cloth that comes to rest farther away than a contact may be: a tenth of the offset and four times the resolution.
inline bool hovers_at_rest(const Right& r, const Motion&) {
  return lies_still(r.facts) && 0.002 > 1.2 * (0.1 * r.facts.offset_m + 4e-4 * r.facts.length_m);
}
inline bool folded(const Facts& f) { return f.self; }
inline bool falls(const Facts& f) { return f.falls; }

std::vector<Lie> lies_of_time();
std::vector<Lie> lies_of_shape();
std::vector<Lie> lies_of_contact();

}  // namespace clothbench::liars
