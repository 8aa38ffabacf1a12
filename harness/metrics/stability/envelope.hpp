#pragma once
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::stability {

/// What physics allows at the end of one frame, from the scene alone. All bounds are generous by design: a run outside
/// them by the factors of judge.hpp is not inaccurate but unstable.
struct Bounds {
  double speed_m_per_s = 0;  ///< v_char: max of free fall, hands, colliders, the start, and strain times wave speed
  double jump_speed_m_per_s =
      0;              ///< of the last jump (a teleport, a start that is not at rest), over its frame; 0 = none yet
  double strain = 0;  ///< greatest strain that loads, hands and colliders can cause (not a prediction)
  double imposed_strain = 0;  ///< greatest strain between two held vertices, taken straight
  double work_J = 0;          ///< most that hands and colliders can have put in so far
  bool jumped = false;        ///< something jumped in this frame
};

/// The bounds of every frame, 0 = the start.
///
/// Free fall: sqrt(2 g H), H = twice the diagonal where the cloth is held, g t^2/2 plus the diagonal where it is not.
/// Waves: a strain e travels at c = sqrt(Y/rho) with particle speed e c. Static strain M g/(Y w), w the shorter side,
/// twice that when loads come suddenly; 3 v/c for hands (the wave and its first reflections), 2 v/c for colliders, v/c
/// for cloth that falls slack and is jerked to a stop.
std::vector<Bounds> envelope(const Scene&);

/// Rest length of the straight line between two vertices [m].
double rest_distance(const Cloth&, std::uint32_t a, std::uint32_t b);

/// Greatest membrane stiffness of the scene [N/m]; 0 = inextensible.
double greatest_stiffness(const Scene&);

}  // namespace clothbench::stability
