#include <numbers>

#include "telling.hpp"

namespace clothbench::liars {
namespace {

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

}  // namespace

const std::vector<Lie>& lies() {
  static const std::vector<Lie> all = [] {
    std::vector<Lie> out = {
        {"the right motion", always, never, [](const Right& r, Dice&) -> Told { return r.motion; }, true},
        {"noise of 0.1 mm per m", always, never,
         [](const Right& r, Dice& dice) -> Told { return noise(r, 1e-4 * r.facts.length_m, dice, true); }, true},
        {"noise of 3 mm", always, surely,
         [](const Right& r, Dice& dice) -> Told { return noise(r, 3e-3 * std::numbers::sqrt3, dice, false); }},
    };
    for (const auto& more : {lies_of_time(), lies_of_shape(), lies_of_contact()})
      out.insert(out.end(), more.begin(), more.end());
    return out;
  }();
  return all;
}

}  // namespace clothbench::liars
