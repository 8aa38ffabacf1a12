#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::truth {

/// A scene with randomly drawn parameters, for which its truth is evaluated.
struct DrawnScene {
  Scene scene;                                         ///< completed; `seed` set
  std::vector<std::pair<std::string, double>> values;  ///< drawn values, for display; names carry units
};

/// Draws the parameters of a scene that falls, swings, hangs, lies on an incline or over a capstan:
///   length in [0.1, 2] m, areal density in [0.05, 1] kg/m^2, gravity in [1, 25] m/s^2;
///   a rotation in SO(3) of everything, gravity included, and an origin up to 10 m away;
///   by reference case: membrane stiffness log-uniform in [100, 1e6] N/m, friction in [0.1, 0.8] (capstan: up to 0.4,
///   beyond which no strip is long enough), slopes and overhangs on the same side of the critical value as the scene.
/// Times, damping and horizons scale with sqrt(L/g). The frame rate is kept unless fewer than 8 frames would remain.
/// The grid is kept except for a capstan. Deterministic: std::mt19937_64 is seeded from the seed and the reference
/// case's name, so all scenes of a reference case in the same state (holds or slips) get the same values on any grid.
/// Throws Error for a scene with another truth or none.
DrawnScene draw(const Scene&, std::uint64_t seed);

}  // namespace clothbench::truth
