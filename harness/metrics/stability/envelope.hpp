#pragma once
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::stability {

/// Physical bounds at the end of one frame, computed only from the scene. All bounds are generous by design: a run that
/// exceeds them by the factors of judge.hpp is not inaccurate but unstable.
struct Bounds {
  double speed_m_per_s = 0;  ///< v_char: max of free fall, hands, colliders, the start, and strain times wave speed
  double jump_speed_m_per_s =
      0;                ///< of the last jump (a teleport, a start that is not at rest), over its frame; 0 = none yet
  double strain = 0;    ///< maximum strain that loads, hands and colliders can cause (not a prediction)
  double work_J = 0;    ///< maximum work that hands and colliders can have done so far
  bool jumped = false;  ///< something jumped in this frame
};

/// The bounds of every frame, 0 = the start.
///
/// Free fall: sqrt(2 g H), H = twice the diagonal for held cloth, g t^2/2 plus the diagonal for free cloth. Waves: a
/// strain e travels at c = sqrt(Y/rho) with particle speed e c. The static strain is M g/(Y w), w the shorter side, and
/// twice that for sudden loads. Added to it are 3 v/c for hands (the wave and its first reflections), 2 v/c for
/// colliders, and v/c for cloth that falls slack and is stopped suddenly.
std::vector<Bounds> envelope(const Scene&);

/// Greatest membrane stiffness of the scene [N/m]; 0 = inextensible.
double greatest_stiffness(const Scene&);

}  // namespace clothbench::stability
