#include "lies.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace clothbench::liars {
namespace {

// The correct motion at other positions or other times.

using Told = std::optional<Motion>;
using Index = std::size_t;

V3 v3(const Vec3& x) { return V3::Map(x.data()); }
Vec3 vec(const V3& x) { return {x[0], x[1], x[2]}; }

V3 direction(Dice& dice) {
  const auto rows = dice.rotation();
  return v3(rows[0]);
}

/// A direction perpendicular to `up`.
V3 level(const V3& up, Dice& dice) {
  for (;;) {
    const V3 d = direction(dice), across = d - d.dot(up) * up;
    if (across.norm() > 0.3) return across.normalized();
  }
}

/// 0 until frame `from`, then smoothly up to 1 within `frames` frames.
double faded(Index k, Index from, double frames) {
  const double x = std::min(static_cast<double>(std::max(k, from) - from) / frames, 1.0);
  return x * x * (3 - 2 * x);
}

/// A random frame well inside a range.
Index between(Index first, Index last, Dice& dice) {
  if (last <= first) return first;
  return first + static_cast<Index>(dice.whole(0, static_cast<int>(last - first)));
}

/// A random frame in which something happens, not among the first or last few.
Index amid(const Right& r, Dice& dice) {
  const Index n = r.motion.frames(), end = std::min(n - 5, std::max<Index>(r.facts.at_rest, 12));
  return std::clamp<Index>(between(6, std::max<Index>(7, end * 3 / 4), dice), 4, n - 5);
}

/// The correct motion with its unattached vertices moved.
template <class Move>
Motion moved(const Right& r, Move move) {
  Motion out = r.motion;
  for (Index k = 0; k < out.frames(); ++k)
    for (Index v = 0; v < out.vertices(); ++v)
      if (!r.held(k, v)) out.put(k, v, vec(V3(move(k, v, v3(r.motion.at(k, v))))));
  return out;
}

/// The correct motion at other times: frame k shows the time of frame `moment(k)`, which may be a fraction.
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

/// Vertices that are unattached in every frame.
std::vector<Index> loose(const Right& r) {
  std::vector<Index> out;
  for (Index v = 0; v < r.motion.vertices(); ++v)
    if (!r.held(0, v)) out.push_back(v);
  return out;
}

// Conditions of lies: whether a lie applies to a scene, and whether positions determine that the motion is wrong.

bool always(const Facts&) { return true; }
bool surely(const Right&, const Motion&) { return true; }
bool never(const Right&, const Motion&) { return false; }
/// For a lie about forces: attachments leave a momentum equation, and the lie changes the force beyond its tolerance.
bool judged(const Right& r, const Motion& told) { return r.facts.equations > 0 && changes_force(r, told); }
bool stiff(const Right& r, const Motion&) { return r.facts.soft_strain < 0.05; }
/// If contact normals differ, frictionless forces on some vertices may equal a force with friction on others.
bool drags(const Right& r, const Motion& told) { return r.facts.slides && judged(r, told); }
bool attached(const Facts& f) { return f.attached; }
bool flies(const Facts& f) { return !f.air.empty(); }
bool drops(const Facts& f) { return f.falls && !f.attached && f.collider; }
bool lies_still(const Facts& f) { return drops(f) && f.at_rest + 24 < f.frames; }
bool has_kinematic(const Facts& f) { return f.kinematic && f.deepest_touch < f.frames; }
/// A vertex displaced in one frame looks like an impact, unless the displacement exceeds the second differences nearby.
template <int Millimetres>
bool beyond_impact(const Right& r, const Motion& told) {
  const Facts& f = r.facts;
  const double floor_m = 1.5 * (20e-4 * f.length_m + 0.75 * f.gravity * f.frame_s * f.frame_s),
               by_m = 1e-3 * Millimetres;
  return by_m > 1.5 * floor_m && by_m > 3 * accelerated_m(r.motion, first_difference(r, told));
}
/// A patch stands still in the air while it and the rest of the cloth should move.
bool hangs_still(const Right& r, const Motion& told) {
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
/// Cloth that comes to rest farther away than contact allows: a tenth of the offset plus four times the resolution.
bool hovers_at_rest(const Right& r, const Motion&) {
  return lies_still(r.facts) && 0.002 > 1.2 * (0.1 * r.facts.offset_m + 4e-4 * r.facts.length_m);
}
bool folded(const Facts& f) { return f.self; }
bool falls(const Facts& f) { return f.falls; }

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

/// A horizontal direction in which a line of attached vertices lets the cloth swing.
V3 across_held_line(const Right& r, Dice& dice) {
  V3 line = V3::Zero();
  Index first = r.motion.vertices();
  for (Index v = 0; v < r.motion.vertices(); ++v) {
    if (!r.held(0, v)) continue;
    first = std::min(first, v);
    const V3 way = v3(r.motion.at(0, v)) - v3(r.motion.at(0, first));
    if (way.norm() > line.norm()) line = way;
  }
  const V3 across = r.facts.up.cross(line);
  return across.norm() > 0.01 * r.facts.length_m ? V3(across.normalized()) : level(r.facts.up, dice);
}

Index in_air(const Right& r, Dice& dice) { return r.facts.air[between(0, r.facts.air.size() - 1, dice)]; }

Motion one_frame(const Right& r, Index frame, const V3& by) {
  return moved(r, [&](Index k, Index, const V3& x) { return k == frame ? V3(x + by) : x; });
}

Motion one_vertex(const Right& r, double by_m, Dice& dice) {
  const std::vector<Index> of = loose(r);
  const Index vertex = of[between(0, of.size() - 1, dice)], frame = amid(r, dice);
  const V3 by = by_m * direction(dice);
  return moved(r, [&](Index k, Index v, const V3& x) { return k == frame && v == vertex ? V3(x + by) : x; });
}

Told without_colliders(const Right& r, bool moving_alone) {
  return r.other([moving_alone](Scene& s) {
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

/// From one frame on, the cloth is on the far side of the collider that it touches, and falls on from there.
Told jumped_through(const Right& r) {
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
    if (k < at) return x;
    const double t = m.time_s[k] - m.time_s[at], frame = m.time_s[at] - m.time_s[at - 1];
    const V3 from = v3(m.at(at, v)), speed = (from - v3(m.at(at - 1, v))) / frame;
    return from - deepest * r.facts.up + t * speed - 0.5 * g * t * t * r.facts.up;
  });
}

}  // namespace

const std::vector<Lie>& lies() {
  static const std::vector<Lie> all = {
      {"the right motion", always, never, [](const Right& r, Dice&) -> Told { return r.motion; }, true},
      {"noise of 0.1 mm per m", always, never,
       [](const Right& r, Dice& dice) -> Told { return noise(r, 1e-4 * r.facts.length_m, dice, true); }, true},
      {"noise of 3 mm", always, surely,
       [](const Right& r, Dice& dice) -> Told { return noise(r, 3e-3 * std::numbers::sqrt3, dice, false); }},
      // --- attachments
      {"pins dropped", attached, surely,
       [](const Right& r, Dice&) -> Told {
         return r.other([](Scene& s) {
           s.pins.vertices.clear();
           s.grips.vertices.clear();
           for (FrameMotion& now : s.motion) now.grip_position_m.clear(), now.grip_held.clear();
           if (s.colliders.empty()) s.motion.clear();
         });
       }},
      {"pins slide 2 cm", attached, surely,
       [](const Right& r, Dice& dice) -> Told {
         Motion out = r.motion;
         const V3 way = 0.02 * level(r.facts.up, dice);
         for (Index k = 0; k < out.frames(); ++k)
           for (Index v = 0; v < out.vertices(); ++v)
             if (r.held(k, v)) out.put(k, v, vec(V3(v3(out.at(k, v)) + faded(k, 0, 20) * way)));
         return out;
       }},
      // --- teleports
      {"10 m up for a frame", always, surely,
       [](const Right& r, Dice& dice) -> Told { return one_frame(r, amid(r, dice), 10 * r.facts.up); }},
      {"3 m sideways for a frame", always, surely,
       [](const Right& r, Dice& dice) -> Told { return one_frame(r, amid(r, dice), 3 * level(r.facts.up, dice)); }},
      {"3 cm sideways for a frame in the air", flies, judged,
       [](const Right& r, Dice& dice) -> Told {
         return one_frame(r, in_air(r, dice), 0.03 * level(r.facts.up, dice));
       }},
      {"frozen, then at rest at once", always, judged,
       [](const Right& r, Dice& dice) -> Told {
         const Index from = amid(r, dice), to = std::min(from + 15, r.motion.frames() - 2),
                     last = r.motion.frames() - 1;
         return moved(
             r, [&](Index k, Index v, const V3& x) { return k < from ? x : v3(r.motion.at(k < to ? from : last, v)); });
       }},
      {"at rest from frame 20", always, judged,
       [](const Right& r, Dice&) -> Told {
         return moved(r, [&](Index k, Index v, const V3& x) { return k < 20 ? x : v3(r.motion.at(20, v)); });
       }},
      {"back at the start", always, judged,
       [](const Right& r, Dice& dice) -> Told {
         const Index from = amid(r, dice);
         return moved(r, [&](Index k, Index v, const V3& x) { return k < from ? x : v3(r.motion.at(0, v)); });
       }},
      {"a frame repeated", always, judged,
       [](const Right& r, Dice&) -> Told {
         const Index at = std::clamp<Index>(r.facts.fastest, 2, r.motion.frames() - 3);
         return moved(r, [&](Index k, Index v, const V3& x) { return k == at ? v3(r.motion.at(k - 1, v)) : x; });
       }},
      {"a frame skipped", always, judged,
       [](const Right& r, Dice&) -> Told {
         const double at = static_cast<double>(std::clamp<Index>(r.facts.fastest, 3, r.motion.frames() - 3));
         return retimed(r, [&](double k) { return k < at ? k : k + 1; });
       }},
      {"gravity 10 % too strong", falls, judged,
       [](const Right& r, Dice&) -> Told {
         return r.other([](Scene& s) {
           for (double& g : s.gravity_m_per_s2) g *= 1.1;
         });
       }},
      // --- physics of another scene
      {"mirrored", always, judged,
       [](const Right& r, Dice&) -> Told {
         V3 middle = V3::Zero();
         for (Index v = 0; v < r.motion.vertices(); ++v)
           middle += v3(r.motion.at(0, v)) / static_cast<double>(r.motion.vertices());
         return moved(r,
                      [&](Index, Index, const V3& x) { return V3(x - 2 * (x - middle).dot(r.facts.up) * r.facts.up); });
       }},
      {"turns back in time", always, judged,
       [](const Right& r, Dice& dice) -> Told {
         const double from = static_cast<double>(amid(r, dice));
         return retimed(r, [from](double k) { return k <= from ? k : 2 * from - k; });
       }},
      {"thrown otherwise", [](const Facts& f) { return !f.attached; }, judged,
       [](const Right& r, Dice& dice) -> Told {
         const V3 by = direction(dice);
         return r.other([by](Scene& s) {
           for (std::size_t i = 0; i < 3; ++i) s.cloth.initial_velocity_m_per_s[i] += by[static_cast<int>(i)];
         });
       }},
      {"gravity leans by 10 degrees", falls, judged,
       [](const Right& r, Dice& dice) -> Told {
         const V3 by = std::tan(10 * std::numbers::pi / 180) * across_held_line(r, dice);
         return r.other([by](Scene& s) {
           const double g = v3(s.gravity_m_per_s2).norm();
           for (std::size_t i = 0; i < 3; ++i) s.gravity_m_per_s2[i] += g * by[static_cast<int>(i)];
         });
       }},
      {"damped by 2/s more", always, judged,
       [](const Right& r, Dice&) -> Told { return r.other([](Scene& s) { s.material.damping_per_s += 2; }); }},
      {"slides without friction", drops, drags,
       [](const Right& r, Dice&) -> Told {
         return r.other([](Scene& s) {
           for (Collider& c : s.colliders) c.friction = 0;
         });
       }},
      {"5 frames late", always, judged,
       [](const Right& r, Dice&) -> Told { return retimed(r, [](double k) { return k - 5; }); }},
      {"double speed", always, judged,
       [](const Right& r, Dice&) -> Told { return retimed(r, [](double k) { return 2 * k; }); }},
      // --- shape
      {"two vertices exchanged", always, surely,
       [](const Right& r, Dice& dice) -> Told {
         const std::vector<Index> of = loose(r);
         if (of.size() < 2) return std::nullopt;
         const Index from = amid(r, dice), a = of[between(0, of.size() / 2 - 1, dice)],
                     b = of[between(of.size() / 2, of.size() - 1, dice)];
         return moved(r, [&](Index k, Index v, const V3& x) {
           return k < from ? x : v == a ? v3(r.motion.at(k, b)) : v == b ? v3(r.motion.at(k, a)) : x;
         });
       }},
      {"a vertex 1 cm off for a frame", always, beyond_impact<10>,
       [](const Right& r, Dice& dice) -> Told { return one_vertex(r, 0.01, dice); }},
      {"a vertex 10 cm off for a frame", always, beyond_impact<100>,
       [](const Right& r, Dice& dice) -> Told { return one_vertex(r, 0.1, dice); }},
      {"smoothed over 5 frames", always, judged,
       [](const Right& r, Dice&) -> Told {
         const auto last = static_cast<int>(r.motion.frames()) - 1;
         return moved(r, [&](Index k, Index v, const V3& x) {
           if (k == 0) return x;
           V3 sum = V3::Zero();
           for (int o = -2; o <= 2; ++o)
             sum += v3(r.motion.at(static_cast<Index>(std::clamp(static_cast<int>(k) + o, 0, last)), v)) / 5;
           return sum;
         });
       }},
      {"shrunk by 5 %", always, stiff,
       [](const Right& r, Dice&) -> Told {
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
           return V3(about + (1 - 0.05 * faded(k, 0, 10)) * (x - about));
         });
       }},
      {"a patch frozen for 10 frames", always, hangs_still,
       [](const Right& r, Dice& dice) -> Told {
         const Cloth& c = r.motion.scene->cloth;
         // While it moves: at the highest speed it may be about to come to rest.
         const Index at = std::clamp<Index>(std::max<Index>(r.facts.fastest, 5) - 5, 3, r.motion.frames() - 12);
         const int i = dice.whole(1, std::max(1, c.columns - 5)),
                   j = dice.whole(c.rows / 2, std::max(c.rows / 2, c.rows - 5));
         return moved(r, [&](Index k, Index v, const V3& x) {
           const int a = static_cast<int>(v) % c.columns, b = static_cast<int>(v) / c.columns;
           const bool in = a >= i && a < i + 4 && b >= j && b < j + 4 && k > at && k <= at + 10;
           return in ? v3(r.motion.at(at, v)) : x;
         });
       }},
      {"buzz of 2 mm", always, judged,
       [](const Right& r, Dice& dice) -> Told {
         const V3 by = 0.002 * direction(dice);
         return moved(r, [&](Index k, Index, const V3& x) { return V3(x + (k % 2 == 0 ? 0.0 : 1.0) * by); });
       }},
      // --- contact
      {"hovers by 2 mm", drops, hovers_at_rest,
       [](const Right& r, Dice&) -> Told {
         Told out = r.other([](Scene& s) {
           for (Collider& c : s.colliders) c.margin_m += 0.002;
         });
         if (out) out->contact_offsets_m = r.motion.contact_offsets_m;
         return out;
       }},
      {"sinks into the solid by 1 cm", drops, surely,
       [](const Right& r, Dice&) -> Told {
         const Index from = r.facts.first_touch;
         // The contact offset is not solid.
         double deep_m = 0.01;
         for (std::size_t c = 0; c < r.motion.scene->colliders.size(); ++c) {
           const double margin = r.motion.scene->colliders[c].margin_m;
           const double said = c < r.motion.contact_offsets_m.size() ? r.motion.contact_offsets_m[c] : margin;
           deep_m = std::max(deep_m, 0.01 + margin + (std::isfinite(said) ? std::max(said, margin) : margin));
         }
         return moved(r, [&](Index k, Index, const V3& x) { return V3(x - deep_m * faded(k, from, 20) * r.facts.up); });
       }},
      {"falls through", drops, surely, [](const Right& r, Dice&) -> Told { return without_colliders(r, false); }},
      {"ignores the mover", has_kinematic, surely,
       [](const Right& r, Dice&) -> Told { return without_colliders(r, true); }},
      {"jumps through", drops, surely, [](const Right& r, Dice&) -> Told { return jumped_through(r); }},
      {"slides at 0.5 m/s", lies_still, surely,
       [](const Right& r, Dice& dice) -> Told {
         const V3 by = 0.5 * level(r.facts.up, dice);
         const Index from = r.facts.at_rest;
         return moved(r, [&](Index k, Index, const V3& x) {
           return k > from ? V3(x + (r.motion.time_s[k] - r.motion.time_s[from]) * by) : x;
         });
       }},
      {"a layer of folded cloth through another", folded, surely,
       [](const Right& r, Dice&) -> Told {
         const Cloth& c = r.motion.scene->cloth;
         const double by = -3 * c.self_collision.thickness_m;
         const Index from = r.motion.frames() / 2;
         return moved(r, [&](Index k, Index v, const V3& x) {
           const bool upper = static_cast<int>(v) % c.columns < c.columns / 3;
           return upper ? V3(x + by * faded(k, from, 20) * r.facts.up) : x;
         });
       }},
      // --- files
      {"every second frame missing", always, surely,
       [](const Right& r, Dice&) -> Told {
         Motion out = r.motion;
         out.time_s.clear(), out.position.clear();
         const Index numbers = 3 * r.motion.vertices();
         for (Index k = 0; k < r.motion.frames(); k += 2) {
           out.time_s.push_back(r.motion.time_s[k]);
           const auto from = r.motion.position.begin() + static_cast<std::ptrdiff_t>(k * numbers);
           out.position.insert(out.position.end(), from, from + static_cast<std::ptrdiff_t>(numbers));
         }
         return out;
       }},
      {"one position NaN", always, surely,
       [](const Right& r, Dice& dice) -> Told {
         Motion out = r.motion;
         const double none = std::numeric_limits<double>::quiet_NaN();
         out.put(amid(r, dice), between(0, out.vertices() - 1, dice), {none, none, none});
         return out;
       }},
  };
  return all;
}

}  // namespace clothbench::liars
