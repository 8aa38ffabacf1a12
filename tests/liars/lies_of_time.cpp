// Attached vertices elsewhere, other moments, other places for a frame, other scenes.
#include <Eigen/Geometry>
#include <numbers>

#include "telling.hpp"

namespace clothbench::liars {
namespace {

/// A level direction in which a line of held vertices lets the cloth swing.
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

}  // namespace

std::vector<Lie> lies_of_time() {
  return {
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
  };
}

}  // namespace clothbench::liars
