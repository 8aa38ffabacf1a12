#include <array>
#include <numbers>

#include "telling.hpp"

namespace clothbench::liars {
namespace {

bool always(const Facts&) { return true; }
bool surely(const Right&, const Motion&) { return true; }
bool never(const Right&, const Motion&) { return false; }
/// Positions tell a lie about forces if attachments leave an equation and it changes them beyond a tolerance.
bool judged(const Right& r, const Motion& told) { return r.facts.equations > 0 && changes_force(r, told); }
bool stiff(const Right& r, const Motion&) { return r.facts.soft_strain < 0.05; }
/// Where normals differ, a force without friction may be one with friction on other vertices.
bool drags(const Right& r, const Motion& told) { return r.facts.slides && judged(r, told); }
bool attached(const Facts& f) { return f.attached; }
bool flies(const Facts& f) { return !f.air.empty(); }
bool drops(const Facts& f) { return f.falls && !f.attached && f.solid; }
bool lies_still(const Facts& f) { return drops(f) && f.at_rest + 24 < f.frames; }
bool has_mover(const Facts& f) { return f.mover && f.deepest_touch < f.frames; }
/// An impact may move a vertex in a frame by as much as the cloth moves in it.
template <int Millimetres>
bool beyond_impact(const Right& r, const Motion&) {
  const Facts& f = r.facts;
  const double floor_m = 1.5 * (20e-4 * f.length_m + 0.75 * f.gravity * f.frame_s * f.frame_s),
               by_m = 1e-3 * Millimetres;
  return by_m > 1.5 * floor_m && (f.first_touch == f.frames || by_m > f.speed_m_per_s * f.frame_s);
}
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

}  // namespace

std::span<const Lie> lies() {
  static constexpr std::array kAll = std::to_array<Lie>({
      {"the right motion", true, always, never, right},
      {"noise of 0.1 mm per m", true, always, never, small_noise},
      {"pins dropped", false, attached, surely, pins_dropped},
      {"pins drift 1.2 m", false, attached, surely, pins_drift},
      {"pins slide 2 cm", false, attached, surely, pins_slide},
      {"10 m up for a frame", false, always, surely, up_10m},
      {"20 m sideways for a frame", false, always, surely, sideways_20m},
      {"3 m sideways for a frame", false, always, surely, sideways_3m},
      {"3 cm sideways for a frame in the air", false, flies, judged, sideways_3cm},
      {"frozen, then at rest at once", false, always, judged, frozen_then_rest},
      {"at rest from frame 20", false, always, judged, rests_from_20},
      {"at rest too early", false, always, judged, rests_early},
      {"back at the start", false, always, judged, back_to_start},
      {"a frame repeated", false, always, judged, frame_repeated},
      {"a frame skipped", false, always, judged, frame_skipped},
      {"gravity of a quarter", false, falls, judged, quarter_gravity},
      {"gravity 10 % too strong", false, falls, judged, strong_gravity},
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
      {"vertices permuted", false, always, surely, permuted},
      {"two vertices exchanged", false, always, surely, two_swapped},
      {"a vertex 1 cm off for a frame", false, always, beyond_impact<10>, vertex_1cm},
      {"a vertex 3 cm off for a frame", false, always, beyond_impact<30>, vertex_3cm},
      {"a vertex 10 cm off for a frame", false, always, surely, vertex_10cm},
      {"smoothed over 5 frames", false, always, judged, smoothed},
      {"shrunk by 5 %", false, always, stiff, shrunk},
      {"a patch frozen for 10 frames", false, always, surely, patch_frozen},
      {"buzz of 2 mm", false, always, judged, buzz},
      {"a band buzzes by 1 cm at 9 Hz", false, always, judged, band_buzz},
      {"noise of 3 mm", false, always, surely, large_noise},
      {"hovers by 5 cm", false, drops, surely, hovers_5cm},
      {"hovers by 2 mm", false, drops, surely, hovers_2mm},
      {"sinks into the solid by 1 cm", false, drops, surely, sinks_1cm},
      {"a border sinks by 5 cm", false, lies_still, surely, border_sinks},
      {"falls through", false, drops, surely, falls_through},
      {"slides at 0.5 m/s", false, lies_still, surely, slides},
      {"drifts in the air", false, [](const Facts& f) { return !f.attached; }, surely, drifts},
      {"slides without friction", false, drops, drags, slippery},
      {"ignores the mover", false, has_mover, surely, ignores_mover},
      {"jumps back through the mover", false, has_mover, surely, jumps_back},
      {"jumps through", false, drops, surely, jumps_through},
      {"through and back", false, drops, surely, through_and_back},
      {"a layer of folded cloth through another", false, folded, surely, layer_off},
      {"layers exchanged", false, folded, surely, layers_exchanged},
      {"every second frame missing", false, always, surely, half_missing},
      {"one position NaN", false, always, surely, one_nan},
      {"all positions NaN", false, always, surely, all_nan},
  });
  return kAll;
}

}  // namespace clothbench::liars
