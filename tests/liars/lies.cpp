#include "lies.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace clothbench::liars {
namespace {

using Told = std::optional<Motion>;
using Index = std::size_t;

V3 v3(const Vec3& x) { return V3::Map(x.data()); }
Vec3 vec(const V3& x) { return {x[0], x[1], x[2]}; }

V3 direction(Dice& dice) {
  const auto rows = dice.rotation();
  return v3(rows[0]);
}

/// A direction across `up`.
V3 level(const V3& up, Dice& dice) {
  for (;;) {
    const V3 d = direction(dice), across = d - d.dot(up) * up;
    if (across.norm() > 0.3) return across.normalized();
  }
}

double smooth(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

/// A frame well inside a range.
Index between(Index first, Index last, Dice& dice) {
  if (last <= first) return first;
  return first + static_cast<Index>(dice.whole(0, static_cast<int>(last - first)));
}

/// A frame of the motion with something going on, not among the first or last few.
Index amid(const Right& r, Dice& dice) {
  const Index n = r.motion.frames(), end = std::min(n - 5, std::max<Index>(r.facts.at_rest, 12));
  return std::clamp<Index>(between(6, std::max<Index>(7, end * 3 / 4), dice), 4, n - 5);
}

Index in_air(const Right& r, Dice& dice) { return r.facts.air[between(0, r.facts.air.size() - 1, dice)]; }

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

Motion one_frame(const Right& r, Index frame, const V3& by) {
  return moved(r, [&](Index k, Index, const V3& x) { return k == frame ? V3(x + by) : x; });
}

/// Vertices that may be told lies of in any frame.
std::vector<Index> loose(const Right& r) {
  std::vector<Index> out;
  for (Index v = 0; v < r.motion.vertices(); ++v)
    if (!r.held(0, v)) out.push_back(v);
  return out;
}

Motion one_vertex(const Right& r, double by_m, Dice& dice) {
  const std::vector<Index> of = loose(r);
  const Index vertex = of[between(0, of.size() - 1, dice)], frame = amid(r, dice);
  const V3 by = by_m * direction(dice);
  return moved(r, [&](Index k, Index v, const V3& x) { return k == frame && v == vertex ? V3(x + by) : x; });
}

Told without_colliders(const Right& r, bool moving_alone) {
  return r.other(moving_alone ? "no-mover" : "no-collider", [moving_alone](Scene& s) {
    std::vector<Collider> kept;
    std::vector<std::size_t> which;
    for (std::size_t k = 0; k < s.colliders.size(); ++k)
      if (moving_alone && !s.colliders[k].moves()) kept.push_back(s.colliders[k]), which.push_back(k);
    for (FrameMotion& now : s.motion) {
      std::vector<ColliderPose> poses;
      for (const std::size_t k : which)
        if (k < now.colliders.size()) poses.push_back(now.colliders[k]);
      now.colliders = std::move(poses);
    }
    s.colliders = std::move(kept);
    s.jumps.clear();
    if (s.grips.vertices.empty() && s.colliders.empty()) s.motion.clear();
  });
}

Told heavier(const Right& r, const char* what, double factor) {
  return r.other(what, [factor](Scene& s) {
    for (double& g : s.gravity_m_per_s2) g *= factor;
  });
}

Told hovering(const Right& r, const char* what, double by_m) {
  Told out = r.other(what, [by_m](Scene& s) {
    for (Collider& c : s.colliders) c.margin_m += by_m;
  });
  if (out) out->contact_offsets_m = r.motion.contact_offsets_m;
  return out;
}

/// From a frame on the cloth is elsewhere, beyond the collider that it touches, and falls on from there.
Told jumped_through(const Right& r, bool and_back) {
  const Motion& m = r.motion;
  const Index at = std::min(r.facts.first_touch + 1, m.frames() - 4);
  double deepest = 0, g = 0;
  for (const double x : m.scene->gravity_m_per_s2) g += x * x;
  g = std::sqrt(g);
  for (const Collider& c : m.scene->colliders)
    if (c.shape == Collider::Shape::Box) {
      double half = 0;
      for (std::size_t a = 0; a < 3; ++a) half += std::abs(v3(c.axes[a]).dot(r.facts.up)) * c.half_extent_m[a];
      deepest = std::max(deepest, std::min(2 * half, 0.12) + 2 * c.margin_m + 0.01);
    }
  if (deepest == 0) return std::nullopt;
  return moved(r, [&](Index k, Index v, const V3& x) -> V3 {
    if (k < at || (and_back && k > at)) return x;
    const double t = m.time_s[k] - m.time_s[at], frame = m.time_s[at] - m.time_s[at - 1];
    const V3 from = v3(m.at(at, v)), speed = (from - v3(m.at(at - 1, v))) / frame;
    return from - deepest * r.facts.up + t * speed - 0.5 * g * t * t * r.facts.up;
  });
}

template <int Percent>
Told gravity_of(const Right& r, Dice&) {
  return heavier(r, Percent == 25 ? "gravity-quarter" : "gravity-110", Percent / 100.0);
}

bool always(const Facts&) { return true; }
bool never(const Facts&) { return false; }
bool attached(const Facts& f) { return f.attached; }
bool judged(const Facts& f) { return f.equations > 0; }
bool flies(const Facts& f) { return !f.air.empty(); }
bool drops(const Facts& f) { return f.falls && !f.attached && f.solid; }
bool lies_still(const Facts& f) { return drops(f) && f.at_rest + 24 < f.frames; }
bool has_mover(const Facts& f) { return f.mover && f.deepest_touch < f.frames; }
bool folded(const Facts& f) { return f.self; }
bool falls(const Facts& f) { return f.falls; }

Told right(const Right& r, Dice&) { return r.motion; }

Told noise(const Right& r, double size_m, Dice& dice, bool held_too) {
  Motion out = r.motion;
  for (Index k = 0; k < out.frames(); ++k)
    for (Index v = 0; v < out.vertices(); ++v) {
      if (!held_too && r.held(k, v)) continue;
      V3 x = v3(out.at(k, v));
      for (int i = 0; i < 3; ++i) x[i] += dice.between(-size_m, size_m);
      out.put(k, v, vec(x));
    }
  return out;
}
Told small_noise(const Right& r, Dice& dice) { return noise(r, 1e-4 * r.facts.length_m, dice, true); }
Told large_noise(const Right& r, Dice& dice) { return noise(r, 3e-3 * std::numbers::sqrt3, dice, false); }

// --- attachments

Told pins_dropped(const Right& r, Dice&) {
  return r.other("no-pins", [](Scene& s) {
    s.pins.vertices.clear();
    s.grips.vertices.clear();
    for (FrameMotion& now : s.motion) now.grip_position_m.clear(), now.grip_held.clear();
    if (s.colliders.empty()) s.motion.clear();
  });
}

Told pins_drift(const Right& r, Dice& dice) {
  Motion out = r.motion;
  const V3 way = 1.2 * level(r.facts.up, dice);
  for (Index k = 0; k < out.frames(); ++k)
    for (Index v = 0; v < out.vertices(); ++v)
      out.put(k, v, vec(V3(v3(out.at(k, v)) + static_cast<double>(k) / static_cast<double>(out.frames()) * way)));
  return out;
}

Told pins_slide(const Right& r, Dice& dice) {
  Motion out = r.motion;
  const V3 way = 0.02 * level(r.facts.up, dice);
  for (Index k = 0; k < out.frames(); ++k)
    for (Index v = 0; v < out.vertices(); ++v)
      if (r.held(k, v)) out.put(k, v, vec(V3(v3(out.at(k, v)) + smooth(static_cast<double>(k) / 20) * way)));
  return out;
}

// --- teleports

Told up_10m(const Right& r, Dice& dice) { return one_frame(r, amid(r, dice), 10 * r.facts.up); }
Told sideways_20m(const Right& r, Dice& dice) { return one_frame(r, amid(r, dice), 20 * level(r.facts.up, dice)); }
Told sideways_3m(const Right& r, Dice& dice) { return one_frame(r, amid(r, dice), 3 * level(r.facts.up, dice)); }
Told sideways_3cm(const Right& r, Dice& dice) { return one_frame(r, in_air(r, dice), 0.03 * level(r.facts.up, dice)); }

Told frozen_then_rest(const Right& r, Dice& dice) {
  const Index from = amid(r, dice), to = std::min(from + 15, r.motion.frames() - 2), last = r.motion.frames() - 1;
  return moved(r,
               [&](Index k, Index v, const V3& x) { return k < from ? x : v3(r.motion.at(k < to ? from : last, v)); });
}
Told rests_from_20(const Right& r, Dice&) {
  return moved(r, [&](Index k, Index v, const V3& x) { return k < 20 ? x : v3(r.motion.at(20, v)); });
}
Told rests_early(const Right& r, Dice& dice) {
  const Index from = amid(r, dice), last = r.motion.frames() - 1;
  return moved(r, [&](Index k, Index v, const V3& x) {
    const double share = smooth(static_cast<double>(k < from ? 0 : k - from) / 10);
    return V3((1 - share) * x + share * v3(r.motion.at(last, v)));
  });
}
Told back_to_start(const Right& r, Dice& dice) {
  const Index from = amid(r, dice);
  return moved(r, [&](Index k, Index v, const V3& x) { return k < from ? x : v3(r.motion.at(0, v)); });
}
Told frame_repeated(const Right& r, Dice&) {
  const Index at = std::clamp<Index>(r.facts.fastest, 2, r.motion.frames() - 3);
  return moved(r, [&](Index k, Index v, const V3& x) { return k == at ? v3(r.motion.at(k - 1, v)) : x; });
}
Told frame_skipped(const Right& r, Dice&) {
  const double at = static_cast<double>(std::clamp<Index>(r.facts.fastest, 3, r.motion.frames() - 3));
  return retimed(r, [&](double k) { return k < at ? k : k + 1; });
}

// --- physics of another scene

Told mirrored(const Right& r, Dice&) {
  V3 middle = V3::Zero();
  for (Index v = 0; v < r.motion.vertices(); ++v)
    middle += v3(r.motion.at(0, v)) / static_cast<double>(r.motion.vertices());
  return moved(r, [&](Index, Index, const V3& x) { return V3(x - 2 * (x - middle).dot(r.facts.up) * r.facts.up); });
}
Told backwards(const Right& r, Dice&) {
  const double last = static_cast<double>(r.motion.frames() - 1);
  return retimed(r, [last](double k) { return last - k; });
}
Told rises_again(const Right& r, Dice& dice) {
  const double from = static_cast<double>(amid(r, dice));
  return retimed(r, [from](double k) { return k <= from ? k : 2 * from - k; });
}
Told other_throw(const Right& r, Dice& dice) {
  const V3 by = direction(dice);
  return r.other("throw", [by](Scene& s) {
    for (std::size_t i = 0; i < 3; ++i) s.cloth.initial_velocity_m_per_s[i] += by[static_cast<int>(i)];
  });
}
Told leaning_gravity(const Right& r, Dice& dice) {
  const V3 by = std::tan(10 * std::numbers::pi / 180) * level(r.facts.up, dice);
  return r.other("leaning", [by](Scene& s) {
    const double g = v3(s.gravity_m_per_s2).norm();
    for (std::size_t i = 0; i < 3; ++i) s.gravity_m_per_s2[i] += g * by[static_cast<int>(i)];
  });
}
Told damped(const Right& r, Dice&) {
  return r.other("damped", [](Scene& s) { s.material.damping_per_s += 2; });
}
Told slippery(const Right& r, Dice&) {
  return r.other("slippery", [](Scene& s) {
    for (Collider& c : s.colliders) c.friction = 0;
  });
}
Told five_late(const Right& r, Dice&) {
  return retimed(r, [](double k) { return k - 5; });
}
Told five_early(const Right& r, Dice&) {
  return retimed(r, [](double k) { return k == 0 ? 0 : k + 5; });
}
Told half_speed(const Right& r, Dice&) {
  return retimed(r, [](double k) { return k / 2; });
}
Told double_speed(const Right& r, Dice&) {
  return retimed(r, [](double k) { return 2 * k; });
}

// --- shape

Told permuted(const Right& r, Dice& dice) {
  const std::vector<Index> of = loose(r);
  std::vector<Index> to(r.motion.vertices());
  std::iota(to.begin(), to.end(), Index{0});
  for (Index i = of.size(); i-- > 1;) std::swap(to[of[i]], to[of[between(0, i, dice)]]);
  return moved(r, [&](Index k, Index v, const V3& x) { return k == 0 ? x : v3(r.motion.at(k, to[v])); });
}
Told two_swapped(const Right& r, Dice& dice) {
  const std::vector<Index> of = loose(r);
  const Index from = amid(r, dice), a = of[between(0, of.size() / 2, dice)],
              b = of[between(of.size() / 2 + 1, of.size() - 1, dice)];
  return moved(r, [&](Index k, Index v, const V3& x) {
    return k < from ? x : v == a ? v3(r.motion.at(k, b)) : v == b ? v3(r.motion.at(k, a)) : x;
  });
}
Told vertex_1cm(const Right& r, Dice& dice) { return one_vertex(r, 0.01, dice); }
Told vertex_3cm(const Right& r, Dice& dice) { return one_vertex(r, 0.03, dice); }
Told vertex_10cm(const Right& r, Dice& dice) { return one_vertex(r, 0.1, dice); }
Told smoothed(const Right& r, Dice&) {
  const auto last = static_cast<int>(r.motion.frames()) - 1;
  return moved(r, [&](Index k, Index v, const V3& x) {
    if (k == 0) return x;
    V3 sum = V3::Zero();
    for (int o = -2; o <= 2; ++o)
      sum += v3(r.motion.at(static_cast<Index>(std::clamp(static_cast<int>(k) + o, 0, last)), v)) / 5;
    return sum;
  });
}
Told shrunk(const Right& r, Dice&) {
  V3 middle = V3::Zero();
  double held = 0;
  for (Index v = 0; v < r.motion.vertices(); ++v)
    if (r.held(0, v)) middle += v3(r.motion.at(0, v)), ++held;
  return moved(r, [&](Index k, Index, const V3& x) {
    V3 about = middle / std::max(held, 1.0);
    if (held == 0) {
      about = V3::Zero();
      for (Index v = 0; v < r.motion.vertices(); ++v)
        about += v3(r.motion.at(k, v)) / static_cast<double>(r.motion.vertices());
    }
    return V3(about + (1 - 0.05 * smooth(static_cast<double>(k) / 10)) * (x - about));
  });
}
Told patch_frozen(const Right& r, Dice& dice) {
  const Cloth& c = r.motion.scene->cloth;
  const Index at = std::min(std::max<Index>(r.facts.fastest, 3), r.motion.frames() - 12);
  const int i = dice.whole(1, std::max(1, c.columns - 5)), j = dice.whole(c.rows / 2, std::max(c.rows / 2, c.rows - 5));
  return moved(r, [&](Index k, Index v, const V3& x) {
    const int a = static_cast<int>(v) % c.columns, b = static_cast<int>(v) / c.columns;
    const bool in = a >= i && a < i + 4 && b >= j && b < j + 4 && k > at && k <= at + 10;
    return in ? v3(r.motion.at(at, v)) : x;
  });
}
Told buzz(const Right& r, Dice& dice) {
  const V3 by = 0.002 * direction(dice);
  return moved(r, [&](Index k, Index, const V3& x) { return V3(x + (k % 2 == 0 ? 0.0 : 1.0) * by); });
}
Told band_buzz(const Right& r, Dice& dice) {
  const Cloth& c = r.motion.scene->cloth;
  const V3 by = 0.01 * direction(dice);
  return moved(r, [&](Index k, Index v, const V3& x) {
    const double phase = 2 * std::numbers::pi * 9 * r.motion.time_s[k];
    return static_cast<int>(v) % c.columns < c.columns / 4 ? V3(x + std::sin(phase) * by) : x;
  });
}

// --- contact

Told hovers_5cm(const Right& r, Dice&) { return hovering(r, "hover-50", 0.05); }
Told hovers_2mm(const Right& r, Dice&) { return hovering(r, "hover-2", 0.002); }
Told sinks_1cm(const Right& r, Dice&) {
  const Index from = r.facts.first_touch;
  return moved(r, [&](Index k, Index, const V3& x) {
    return V3(x - 0.01 * smooth(static_cast<double>(k < from ? 0 : k - from) / 20) * r.facts.up);
  });
}
Told border_sinks(const Right& r, Dice&) {
  const Cloth& c = r.motion.scene->cloth;
  const Index from = r.facts.at_rest;
  return moved(r, [&](Index k, Index v, const V3& x) {
    const bool border = static_cast<int>(v) % c.columns == 0;
    return border && k > from ? V3(x - 0.05 * smooth(static_cast<double>(k - from) / 30) * r.facts.up) : x;
  });
}
Told falls_through(const Right& r, Dice&) { return without_colliders(r, false); }
Told ignores_mover(const Right& r, Dice&) { return without_colliders(r, true); }
Told jumps_back(const Right& r, Dice&) {
  const Told other = without_colliders(r, true);
  if (!other) return std::nullopt;
  const Index from = r.facts.deepest_touch;
  return moved(r, [&](Index k, Index v, const V3& x) { return k < from ? x : v3(other->at(k, v)); });
}
Told jumps_through(const Right& r, Dice&) { return jumped_through(r, false); }
Told through_and_back(const Right& r, Dice&) { return jumped_through(r, true); }
Told slides(const Right& r, Dice& dice) {
  const V3 by = 0.5 * level(r.facts.up, dice);
  const Index from = r.facts.at_rest;
  return moved(r, [&](Index k, Index, const V3& x) {
    return k > from ? V3(x + (r.motion.time_s[k] - r.motion.time_s[from]) * by) : x;
  });
}
Told drifts(const Right& r, Dice& dice) {
  const V3 by = 0.5 * level(r.facts.up, dice);
  return moved(r, [&](Index k, Index, const V3& x) { return V3(x + r.motion.time_s[k] * by); });
}
Told layer_off(const Right& r, Dice&) {
  const Cloth& c = r.motion.scene->cloth;
  const double by = -3 * c.self_collision.thickness_m;
  const Index from = r.motion.frames() / 2;
  return moved(r, [&](Index k, Index v, const V3& x) {
    const bool upper = static_cast<int>(v) % c.columns < c.columns / 3;
    return upper ? V3(x + by * smooth(static_cast<double>(k < from ? 0 : k - from) / 20) * r.facts.up) : x;
  });
}
Told layers_exchanged(const Right& r, Dice&) {
  const Cloth& c = r.motion.scene->cloth;
  const Index from = r.motion.frames() / 2, columns = static_cast<Index>(c.columns);
  return moved(r, [&](Index k, Index v, const V3& x) {
    const Index twin = v - v % columns + (columns - 1 - v % columns);
    const double share = smooth(static_cast<double>(k < from ? 0 : k - from) / 20);
    return V3((1 - share) * x + share * v3(r.motion.at(k, twin)));
  });
}

// --- files

Told half_missing(const Right& r, Dice&) {
  Motion out = r.motion;
  out.time_s.clear(), out.position.clear();
  const Index numbers = 3 * r.motion.vertices();
  for (Index k = 0; k < r.motion.frames(); k += 2) {
    out.time_s.push_back(r.motion.time_s[k]);
    const auto from = r.motion.position.begin() + static_cast<std::ptrdiff_t>(k * numbers);
    out.position.insert(out.position.end(), from, from + static_cast<std::ptrdiff_t>(numbers));
  }
  return out;
}
Told one_nan(const Right& r, Dice& dice) {
  Motion out = r.motion;
  const double none = std::numeric_limits<double>::quiet_NaN();
  out.put(amid(r, dice), between(0, out.vertices() - 1, dice), {none, none, none});
  return out;
}
Told all_nan(const Right& r, Dice&) {
  Motion out = r.motion;
  std::fill(out.position.begin(), out.position.end(), std::numeric_limits<float>::quiet_NaN());
  return out;
}

}  // namespace

std::span<const Lie> lies() {
  static constexpr std::array kAll = std::to_array<Lie>({
      {"the right motion", true, always, never, right},
      {"noise of 0.1 mm per m", true, always, never, small_noise},
      {"pins dropped", false, attached, always, pins_dropped},
      {"pins drift 1.2 m", false, attached, always, pins_drift},
      {"pins slide 2 cm", false, attached, always, pins_slide},
      {"10 m up for a frame", false, always, always, up_10m},
      {"20 m sideways for a frame", false, always, always, sideways_20m},
      {"3 m sideways for a frame", false, always, always, sideways_3m},
      {"3 cm sideways for a frame in the air", false, flies, judged, sideways_3cm},
      {"frozen, then at rest at once", false, always, judged, frozen_then_rest},
      {"at rest from frame 20", false, always, judged, rests_from_20},
      {"at rest too early", false, always, judged, rests_early},
      {"back at the start", false, always, judged, back_to_start},
      {"a frame repeated", false, always, judged, frame_repeated},
      {"a frame skipped", false, always, judged, frame_skipped},
      {"gravity of a quarter", false, falls, judged, gravity_of<25>},
      {"gravity 10 % too strong", false, falls, judged, gravity_of<110>},
      {"gravity leans by 10 degrees", false, falls, judged, leaning_gravity},
      {"thrown otherwise", false, [](const Facts& f) { return !f.attached; }, judged, other_throw},
      {"damped by 2/s more", false, always, judged, damped},
      {"mirrored", false, always, judged, mirrored},
      {"frames backwards", false, always, judged, backwards},
      {"turns back in time", false, always, judged, rises_again},
      {"5 frames late", false, always, judged, five_late},
      {"5 frames early", false, always, judged, five_early},
      {"half speed", false, always, judged, half_speed},
      {"double speed", false, always, judged, double_speed},
      {"vertices permuted", false, always, always, permuted},
      {"two vertices exchanged", false, always, always, two_swapped},
      {"a vertex 1 cm off for a frame", false, always, always, vertex_1cm},
      {"a vertex 3 cm off for a frame", false, always, always, vertex_3cm},
      {"a vertex 10 cm off for a frame", false, always, always, vertex_10cm},
      {"smoothed over 5 frames", false, always, judged, smoothed},
      {"shrunk by 5 %", false, always, always, shrunk},
      {"a patch frozen for 10 frames", false, always, always, patch_frozen},
      {"buzz of 2 mm", false, always, judged, buzz},
      {"a band buzzes by 1 cm at 9 Hz", false, always, judged, band_buzz},
      {"noise of 3 mm", false, always, always, large_noise},
      {"hovers by 5 cm", false, drops, always, hovers_5cm},
      {"hovers by 2 mm", false, drops, always, hovers_2mm},
      {"sinks into the solid by 1 cm", false, drops, always, sinks_1cm},
      {"a border sinks by 5 cm", false, lies_still, always, border_sinks},
      {"falls through", false, drops, always, falls_through},
      {"slides at 0.5 m/s", false, lies_still, always, slides},
      {"drifts in the air", false, [](const Facts& f) { return !f.attached; }, always, drifts},
      {"slides without friction", false, drops, judged, slippery},
      {"ignores the mover", false, has_mover, always, ignores_mover},
      {"jumps back through the mover", false, has_mover, always, jumps_back},
      {"jumps through", false, drops, always, jumps_through},
      {"through and back", false, drops, always, through_and_back},
      {"a layer of folded cloth through another", false, folded, always, layer_off},
      {"layers exchanged", false, folded, always, layers_exchanged},
      {"every second frame missing", false, always, always, half_missing},
      {"one position NaN", false, always, always, one_nan},
      {"all positions NaN", false, always, always, all_nan},
  });
  return kAll;
}

}  // namespace clothbench::liars
