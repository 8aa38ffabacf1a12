// Single vertices, patches, layers and the whole cloth out of shape.
#include <numbers>
#include <numeric>

#include "telling.hpp"

namespace clothbench::liars {
namespace {

Motion one_vertex(const Right& r, double by_m, Dice& dice) {
  const std::vector<Index> of = loose(r);
  const Index vertex = of[between(0, of.size() - 1, dice)], frame = amid(r, dice);
  const V3 by = by_m * direction(dice);
  return moved(r, [&](Index k, Index v, const V3& x) { return k == frame && v == vertex ? V3(x + by) : x; });
}

}  // namespace

std::vector<Lie> lies_of_shape() {
  return {
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
  };
}

}  // namespace clothbench::liars
