#pragma once
// What lies are made of: a right motion at other places, at other moments.
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

inline double smooth(double x) {
  x = std::clamp(x, 0.0, 1.0);
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

/// Tellers of lies: see the table in lies.cpp.
Told quarter_gravity(const Right&, Dice&);
Told strong_gravity(const Right&, Dice&);
Told pins_dropped(const Right&, Dice&);
Told pins_drift(const Right&, Dice&);
Told pins_slide(const Right&, Dice&);
Told up_10m(const Right&, Dice&);
Told sideways_20m(const Right&, Dice&);
Told sideways_3m(const Right&, Dice&);
Told sideways_3cm(const Right&, Dice&);
Told frozen_then_rest(const Right&, Dice&);
Told rests_from_20(const Right&, Dice&);
Told rests_early(const Right&, Dice&);
Told back_to_start(const Right&, Dice&);
Told frame_repeated(const Right&, Dice&);
Told frame_skipped(const Right&, Dice&);
Told mirrored(const Right&, Dice&);
Told backwards(const Right&, Dice&);
Told rises_again(const Right&, Dice&);
Told other_throw(const Right&, Dice&);
Told leaning_gravity(const Right&, Dice&);
Told damped(const Right&, Dice&);
Told slippery(const Right&, Dice&);
Told five_late(const Right&, Dice&);
Told five_early(const Right&, Dice&);
Told half_speed(const Right&, Dice&);
Told double_speed(const Right&, Dice&);
Told permuted(const Right&, Dice&);
Told two_swapped(const Right&, Dice&);
Told vertex_1cm(const Right&, Dice&);
Told vertex_3cm(const Right&, Dice&);
Told vertex_10cm(const Right&, Dice&);
Told smoothed(const Right&, Dice&);
Told shrunk(const Right&, Dice&);
Told patch_frozen(const Right&, Dice&);
Told buzz(const Right&, Dice&);
Told band_buzz(const Right&, Dice&);
Told hovers_5cm(const Right&, Dice&);
Told hovers_2mm(const Right&, Dice&);
Told sinks_1cm(const Right&, Dice&);
Told border_sinks(const Right&, Dice&);
Told falls_through(const Right&, Dice&);
Told ignores_mover(const Right&, Dice&);
Told jumps_back(const Right&, Dice&);
Told jumps_through(const Right&, Dice&);
Told through_and_back(const Right&, Dice&);
Told slides(const Right&, Dice&);
Told drifts(const Right&, Dice&);
Told layer_off(const Right&, Dice&);
Told layers_exchanged(const Right&, Dice&);
Told half_missing(const Right&, Dice&);
Told one_nan(const Right&, Dice&);
Told all_nan(const Right&, Dice&);

}  // namespace clothbench::liars
