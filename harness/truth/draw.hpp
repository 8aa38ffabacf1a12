#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::truth {

/// A scene with randomly drawn parameters, whose truth is evaluated at those.
struct DrawnScene {
  Scene scene;                                         ///< completed; `seed` set
  std::vector<std::pair<std::string, double>> values;  ///< what was drawn, for people; names carry units
};

/// Draws the parameters of a scene with a truth: length in [0.1, 2] m, areal density in [0.05, 1] kg/m^2, gravity in
/// [1, 25] m/s^2, a rotation of everything, gravity too, in SO(3), an origin up to 10 m away, and what is the reference
/// case's own: membrane stiffness log-uniform in [100, 1e6] N/m, weight against bending log-uniform in [1, 1000],
/// friction in [0.1, 0.8] (capstan: 0.4, beyond which no strip is long enough), slopes on the side of the critical
/// angle that the scene is on, overhangs likewise. Times, damping and horizons go with sqrt(L/g) (two-hand-pull: L/c),
/// the frame rate stays unless fewer than 8 frames would be left. Deterministic: std::mt19937_64 from the seed and the
/// reference case's name, so every scene of a reference case that is in the same state (holds or slips) is drawn alike
/// whatever its grid. The grid stays, except where it decides the reference case (capstan, atwood). Throws Error if the
/// scene has no truth.
DrawnScene draw(const Scene&, std::uint64_t seed);

}  // namespace clothbench::truth
