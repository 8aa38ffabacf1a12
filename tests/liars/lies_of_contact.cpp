// Colliders that are ignored, passed or touched wrongly, and files that are not whole.
#include <limits>

#include "telling.hpp"

namespace clothbench::liars {
namespace {

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

/// From a frame on the cloth is elsewhere, beyond the collider that it touches, and falls on from there.
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

std::vector<Lie> lies_of_contact() {
  return {
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
}

}  // namespace clothbench::liars
